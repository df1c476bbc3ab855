// SPDX-License-Identifier: GPL-3.0-or-later
// The program of a wheel: the code is in the Python module beside it, which exports it as `swath_program` (tools/program.h), so that the
// wheel holds it once. What the module takes from the interpreter is not called by the program; python_names.cmake gives it addresses here.
#include <dlfcn.h>

#include <cstdio>
#include <filesystem>

int main(int argc, char** argv) {
  std::error_code ec;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", ec).parent_path().parent_path();
  void* module = dlopen((folder / SWATH_MODULE).c_str(), RTLD_NOW | RTLD_LOCAL);
  using Program = int (*)(int, char**);
  const Program program = module ? reinterpret_cast<Program>(dlsym(module, "swath_program")) : nullptr;
  if (!program) {
    std::fprintf(stderr, "swath: error: %s\n  hint: install the package again\n", dlerror());
    return 1;
  }
  return program(argc, argv);
}
