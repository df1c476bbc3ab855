// SPDX-License-Identifier: GPL-3.0-or-later
// node build.mjs INTO: bundles the pages and writes them as C++ (pages.cpp) and the licences of what they hold (licences.txt).
import { createHash } from 'node:crypto';
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';

const here = dirname(fileURLToPath(import.meta.url));
const into = process.argv[2];
mkdirSync(into, { recursive: true });

async function bundle(entry) {
  const done = await build({
    entryPoints: [join(here, 'src', entry)], bundle: true, minify: true, write: false, format: 'iife', loader: { '.wasm': 'binary' }, target: 'es2022', charset: 'utf8',
    legalComments: 'none', metafile: true, logLevel: 'warning',
  });
  // Within an HTML page nothing may end the script element early.
  return { text: done.outputFiles[0].text.replaceAll('</script', '<\\/script'), inputs: Object.keys(done.metafile.inputs) };
}

/** Name, version, licence and its text for each package that a bundle has taken something from. */
function licences(inputs) {
  const names = new Set(inputs.flatMap((i) => [...i.matchAll(/node_modules\/((?:@[^/]+\/)?[^/]+)\//g)].map((m) => m[1])));
  const parts = [];
  for (const name of [...names].sort()) {
    const folder = join(here, 'node_modules', name);
    const about = JSON.parse(readFileSync(join(folder, 'package.json')));
    const file = readdirSync(folder).find((f) => /^(licen[cs]e|copying)/i.test(f));
    // Packages without the text of their licence: web/licences has it by its SPDX name.
    const text = readFileSync(file ? join(folder, file) : join(here, 'licences', `${about.license}.txt`), 'utf8').trim();
    parts.push(`${name} ${about.version} (${about.license})\n\n${text}\n`);
  }
  return parts.join('\n----\n\n');
}

const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
const escaped = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('>', '&gt;');

const page = await bundle('main.js');
const style = readFileSync(join(here, 'style.css'), 'utf8');
const stream = await bundle('stream.js');
const terms = licences([...page.inputs, ...stream.inputs]);
const policy = (more) =>
  `default-src 'none'; script-src ${hash(page.text)}; style-src ${hash(style)}; img-src data: blob:; base-uri 'none'; form-action 'none'${more}`;
const fixed = { style, licences: escaped(terms), script: page.text };
const html = readFileSync(join(here, 'index.html'), 'utf8').replace(/\{\{(\w+)\}\}/g, (all, name) => fixed[name] ?? all);
const files = {
  page_template: html, stream_script: stream.text, saved_policy: policy(''), served_policy: policy("; connect-src 'self'; worker-src 'self'"),
};
const literal = (text) => {
  // GCC takes literals of any length; the delimiter does not occur in them.
  if (text.includes(')swath"')) throw new Error('the bundle holds the delimiter of its literal');
  return `R"swath(${text})swath"`;
};
let cpp = '// Made by web/build.mjs. Licences of the packages: licences.txt.\n#include "tools/view/pages.h"\n\nnamespace swath::tools {\n\n';
for (const [name, text] of Object.entries(files)) cpp += `const std::string_view ${name} = ${literal(text)};\n`;
cpp += '\n}  // namespace swath::tools\n';
writeFileSync(join(into, 'pages.cpp'), cpp);
writeFileSync(join(into, 'licences.txt'), terms);
