// SPDX-License-Identifier: GPL-3.0-or-later
//! Decompressing: a few chunks at a time, held against their sizes first, so that damaged data cost neither memory nor a crash.

use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};

use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{DecompressionSelection, LasZipDecompressor, LazVlr};

use crate::error::{Error, Result, USAGE};
use crate::input::Input;
use crate::table::{bad, check_items, check_layers, holds_chunks, read_table, smallest_chunk, vlr_is_layered, vlr_is_pointwise, Chunk, LARGEST_CHUNK_BYTES};
use crate::threads::Threads;

/// Decompressed bytes held at once, unless one chunk alone is larger.
const BATCH_BYTES: usize = 64 << 20;
/// Decompressed bytes beyond which a chunk is decompressed piece by piece: a few kilobytes may hold a gigabyte of points.
const WHOLE_CHUNK_BYTES: usize = 8 << 20;
const PIECE_BYTES: usize = 2 << 20;

enum Source {
    /// With a chunk table.
    Chunks { file: Input, chunks: Vec<Chunk>, next: usize },
    /// One run of points without a table: compressor 1, or a writer that never came to its end.
    Stream(Box<LasZipDecompressor<'static, BufReader<Input>>>),
}

/// A chunk of which the first points are decompressed.
struct Large {
    decompressor: Box<dyn RecordDecompressor<Cursor<Vec<u8>>>>,
    number: usize,
    offset: u64,
    left: usize,
}

pub struct Reader {
    source: Source,
    large: Option<Large>,
    vlr: LazVlr,
    record_length: usize,
    fields: DecompressionSelection,
    left: u64,
    threads: Threads,
    ready: Vec<u8>,
    position: usize,
}

fn decompressor_of<'a, S>(
    chunk: S,
    points: usize,
    vlr: &LazVlr,
    record_length: usize,
    fields: DecompressionSelection,
) -> Result<Box<dyn RecordDecompressor<Cursor<S>> + 'a>>
where
    S: AsRef<[u8]> + Send + 'a,
{
    let layered = vlr.items()[0].version() >= 3;
    if layered {
        check_layers(chunk.as_ref(), points, vlr, record_length)?;
    }
    let source = Cursor::new(chunk);
    let mut decompressor: Box<dyn RecordDecompressor<Cursor<S>> + 'a> = if layered {
        Box::new(LayeredPointRecordDecompressor::new(source))
    } else {
        Box::new(SequentialPointRecordDecompressor::new(source))
    };
    decompressor.set_fields_from(vlr.items())?;
    decompressor.set_selection(fields);
    Ok(decompressor)
}

fn decompress_chunk(chunk: &[u8], out: &mut [u8], vlr: &LazVlr, record_length: usize, fields: DecompressionSelection) -> Result<()> {
    decompressor_of(chunk, out.len() / record_length, vlr, record_length, fields)?.decompress_many(out)?;
    Ok(())
}

fn in_chunk(number: usize, offset: u64, e: Error) -> Error {
    Error::new(e.code, format!("chunk {} at byte {}: {}", number, offset, e.message))
}

impl Reader {
    pub fn open(
        mut file: Input,
        data_start: u64,
        vlr: LazVlr,
        point_format: u8,
        record_length: u16,
        points: u64,
        threads: u32,
    ) -> Result<Self> {
        check_items(&vlr, point_format, record_length)?;
        let record_length = usize::from(record_length);
        let table = if points == 0 {
            if holds_chunks(&mut file, data_start, smallest_chunk(&vlr, record_length))? {
                return Err(bad("the header says 0 points, chunks of points follow".to_string()));
            }
            Some(Vec::new())
        } else if vlr_is_pointwise(&vlr) {
            None
        } else {
            read_table(&mut file, data_start, &vlr, record_length, points)?
        };
        let source = match table {
            Some(chunks) => Source::Chunks { file, chunks, next: 0 },
            None if vlr_is_layered(&vlr) || vlr.uses_variable_size_chunks() => {
                return Err(bad("the chunk table is missing: its writer never finished the file"));
            }
            None => {
                let mut input = BufReader::with_capacity(1 << 20, file);
                input.seek(SeekFrom::Start(data_start))?;
                Source::Stream(Box::new(LasZipDecompressor::new(input, vlr.clone())?))
            }
        };
        Self::of(source, vlr, record_length, points, threads)
    }

    /// Only these chunks, one after the other: offset, bytes and points of each.
    pub fn open_chunks(
        file: Input,
        vlr: LazVlr,
        point_format: u8,
        record_length: u16,
        places: impl Iterator<Item = (u64, u64, u64)>,
        threads: u32,
    ) -> Result<Self> {
        check_items(&vlr, point_format, record_length)?;
        let size = file.size()?;
        let record_length = usize::from(record_length);
        let mut chunks = Vec::new();
        let mut all = 0;
        for (i, (offset, bytes, points)) in places.enumerate() {
            if points == 0 || offset > size || bytes > size - offset || bytes < smallest_chunk(&vlr, record_length) {
                return Err(bad(format!("chunk {} of {} points in {} bytes at byte {} does not fit the file", i, points, bytes, offset)));
            }
            if points.saturating_mul(record_length as u64) > LARGEST_CHUNK_BYTES {
                return Err(bad(format!("chunk {} of {} points is too large", i, points)));
            }
            chunks.push(Chunk { offset, bytes: bytes as usize, points: points as usize });
            all += points;
        }
        Self::of(Source::Chunks { file, chunks, next: 0 }, vlr, record_length, all, threads)
    }

    fn of(source: Source, vlr: LazVlr, record_length: usize, points: u64, threads: u32) -> Result<Self> {
        let threads = Threads::new(threads)?;
        let fields = DecompressionSelection::all();
        Ok(Self { source, large: None, vlr, record_length, fields, left: points, threads, ready: Vec::new(), position: 0 })
    }

    /// Before the first point is read.
    pub fn select(&mut self, fields: u32) {
        self.fields = DecompressionSelection(fields);
    }

    pub fn record_length(&self) -> usize {
        self.record_length
    }

    /// Decompresses the next points of a large chunk into `ready`.
    fn next_piece(&mut self) -> Result<()> {
        let Some(large) = &mut self.large else { return Ok(()) };
        let points = large.left.min((PIECE_BYTES / self.record_length).max(1));
        self.ready.resize(points * self.record_length, 0);
        self.position = 0;
        large.decompressor.decompress_many(&mut self.ready).map_err(|e| in_chunk(large.number, large.offset, e.into()))?;
        large.left -= points;
        if large.left == 0 {
            self.large = None;
        }
        Ok(())
    }

    /// Begins with the next chunk where it is a large one.
    fn open_large(&mut self) -> Result<()> {
        let Source::Chunks { file, chunks, next } = &mut self.source else { return Ok(()) };
        let Some(chunk) = chunks.get(*next) else { return Ok(()) };
        if chunk.points * self.record_length <= WHOLE_CHUNK_BYTES {
            return Ok(());
        }
        let mut compressed = vec![0u8; chunk.bytes];
        file.seek(SeekFrom::Start(chunk.offset))?;
        file.read_exact(&mut compressed)?;
        let decompressor =
            decompressor_of(compressed, chunk.points, &self.vlr, self.record_length, self.fields).map_err(|e| in_chunk(*next, chunk.offset, e))?;
        self.large = Some(Large { decompressor, number: *next, offset: chunk.offset, left: chunk.points });
        *next += 1;
        Ok(())
    }

    /// Decompresses the next few chunks, or a piece of a large one, into `ready`.
    fn next_batch(&mut self) -> Result<()> {
        if self.large.is_none() {
            self.open_large()?;
        }
        if self.large.is_some() {
            return self.next_piece();
        }
        let (file, chunks, next) = match &mut self.source {
            Source::Chunks { file, chunks, next } => (file, chunks, next),
            Source::Stream(_) => return Ok(()),
        };
        let first = *next;
        let mut last = first;
        let (mut bytes_in, mut bytes_out) = (0, 0);
        while last < chunks.len() && last - first < self.threads.count() {
            let more = chunks[last].points * self.record_length;
            if last > first && (bytes_out + more > BATCH_BYTES || more > WHOLE_CHUNK_BYTES) {
                break;
            }
            bytes_in += chunks[last].bytes;
            bytes_out += more;
            last += 1;
        }
        if first == last {
            return Err(bad("no chunk left"));
        }
        let mut compressed = vec![0u8; bytes_in];
        let mut rest = &mut compressed[..];
        let mut at = first;
        while at < last {
            // Chunks that follow each other are one read: of an object in a store, one request.
            let (offset, mut bytes) = (chunks[at].offset, 0);
            while at < last && chunks[at].offset == offset + bytes as u64 {
                bytes += chunks[at].bytes;
                at += 1;
            }
            let (head, tail) = rest.split_at_mut(bytes);
            file.seek(SeekFrom::Start(offset))?;
            file.read_exact(head)?;
            rest = tail;
        }
        if self.ready.capacity() < bytes_out {
            self.ready = vec![0u8; bytes_out]; // untouched memory costs nothing where the chunk turns out damaged
        }
        self.ready.resize(bytes_out, 0);
        self.position = 0;

        let mut jobs = Vec::with_capacity(last - first);
        let (mut input, mut output) = (&compressed[..], &mut self.ready[..]);
        for (i, chunk) in chunks.iter().enumerate().take(last).skip(first) {
            let (head_in, tail_in) = input.split_at(chunk.bytes);
            let (head_out, tail_out) = std::mem::take(&mut output).split_at_mut(chunk.points * self.record_length);
            jobs.push((i, chunk.offset, head_in, head_out));
            input = tail_in;
            output = tail_out;
        }
        let (vlr, record_length, fields) = (&self.vlr, self.record_length, self.fields);
        self.threads.map(jobs, |(i, offset, chunk_in, chunk_out)| {
            decompress_chunk(chunk_in, chunk_out, vlr, record_length, fields)
                .map_err(|e| in_chunk(i, offset, e))
        })?;
        *next = last;
        Ok(())
    }

    pub fn read(&mut self, mut out: &mut [u8]) -> Result<()> {
        let n = (out.len() / self.record_length) as u64;
        if n > self.left {
            return Err(Error::new(USAGE, "more points asked for than there are"));
        }
        self.left -= n;
        if let Source::Stream(stream) = &mut self.source {
            stream.decompress_many(out)?;
            return Ok(());
        }
        while !out.is_empty() {
            if self.position == self.ready.len() {
                if let Err(e) = self.next_batch() {
                    self.ready.clear();
                    self.position = 0;
                    return Err(e);
                }
            }
            let n = out.len().min(self.ready.len() - self.position);
            let (head, tail) = out.split_at_mut(n);
            head.copy_from_slice(&self.ready[self.position..self.position + n]);
            self.position += n;
            out = tail;
        }
        Ok(())
    }
}
