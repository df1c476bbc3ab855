// SPDX-License-Identifier: GPL-3.0-or-later
//! Decompressing: a few chunks at a time, held against their sizes first, so that damaged data cost neither memory nor a crash.

use std::fs::File;
use std::io::{BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;

use laz::laszip::{ChunkTable, CompressorType, LazItemType};
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{LasZipDecompressor, LazItemRecordBuilder, LazVlr};

use crate::error::{Error, Result, DATA, USAGE};
use crate::threads::Threads;

/// Decompressed bytes held at once, unless one chunk alone is larger.
const BATCH_BYTES: usize = 64 << 20;
const LARGEST_CHUNK_BYTES: u64 = 1 << 30;
/// Decompressed bytes beyond which a chunk is decompressed piece by piece: a few kilobytes may hold a gigabyte of points.
const WHOLE_CHUNK_BYTES: usize = 8 << 20;
const PIECE_BYTES: usize = 2 << 20;

struct Chunk {
    offset: u64,
    bytes: usize,
    points: usize,
}

enum Source {
    /// With a chunk table.
    Chunks { file: File, chunks: Vec<Chunk>, next: usize },
    /// One run of points without a table: compressor 1, or a writer that never came to its end.
    Stream(Box<LasZipDecompressor<'static, BufReader<File>>>),
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
    left: u64,
    threads: Threads,
    ready: Vec<u8>,
    position: usize,
}

fn bad(message: impl Into<String>) -> Error {
    Error::new(DATA, message)
}

/// The VLR must describe exactly the records of the point format.
fn check_items(vlr: &LazVlr, point_format: u8, record_length: u16) -> Result<()> {
    let standard = LazItemRecordBuilder::default_for_point_format_id(point_format, 0)?;
    let standard_size: u16 = standard.iter().map(|i| i.size()).sum();
    let extra = record_length
        .checked_sub(standard_size)
        .ok_or_else(|| bad("record length too small for the point format"))?;
    let expected = LazItemRecordBuilder::default_for_point_format_id(point_format, extra)?;
    let shape = |item: &laz::LazItem| (u16::from(item.item_type()), item.size());
    if !vlr.items().iter().map(shape).eq(expected.iter().map(shape)) {
        return Err(bad("the laszip VLR describes other fields than the header's point format"));
    }
    let version = vlr.items()[0].version();
    let layered = vlr_is_layered(vlr);
    if vlr.items().iter().any(|i| (i.version() >= 3) != (version >= 3)) || (version >= 3) != layered {
        return Err(bad("the laszip VLR mixes versions"));
    }
    Ok(())
}

fn vlr_is_layered(vlr: &LazVlr) -> bool {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).is_ok() && bytes[0] == CompressorType::LayeredChunked as u8
}

fn vlr_is_pointwise(vlr: &LazVlr) -> bool {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).is_ok() && bytes[0] == CompressorType::PointWise as u8
}

fn u64_at(file: &mut File, at: u64) -> std::io::Result<u64> {
    let mut b = [0u8; 8];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut b)?;
    Ok(u64::from_le_bytes(b))
}

/// Reads the table and holds every number in it against the file. None: the writer never filled its offset.
fn read_table(file: &mut File, data_start: u64, vlr: &LazVlr, record_length: usize, points: u64) -> Result<Option<Vec<Chunk>>> {
    let file_size = file.metadata()?.len();
    let mut table_start = u64_at(file, data_start)?;
    if (table_start as i64) <= data_start as i64 && file_size >= data_start + 16 {
        table_start = u64_at(file, file_size - 8)?; // a writer that cannot seek puts it last
    }
    if table_start as i64 == -1 || (table_start as i64) <= data_start as i64 {
        return Ok(None);
    }
    if table_start < data_start + 8 || table_start + 8 > file_size {
        return Err(bad(format!("chunk table at byte {} is outside the file of {} bytes", table_start, file_size)));
    }
    let chunk_count = u64_at(file, table_start)? >> 32;
    let variable = vlr.uses_variable_size_chunks();
    let chunk_points = u64::from(vlr.chunk_size());
    let room = (table_start - data_start) / record_length as u64; // every chunk starts with one whole record
    let most = room.min(if variable { points } else { points / chunk_points + 1 }) + 1;
    if chunk_count > most {
        return Err(bad(format!("chunk table at byte {} has {} chunks for {} points", table_start, chunk_count, points)));
    }
    file.seek(SeekFrom::Start(data_start))?;
    let table = ChunkTable::read_from(&mut BufReader::new(&mut *file), vlr)
        .map_err(|_| bad(format!("chunk table at byte {} is damaged", table_start)))?;

    let mut chunks = Vec::with_capacity(table.len());
    let (mut offset, mut left) = (data_start + 8, points);
    for (i, entry) in table.as_ref().iter().enumerate() {
        let n = if variable { entry.point_count } else { chunk_points.min(left) };
        if n == 0 && !variable {
            if entry.byte_count >= smallest_chunk(vlr, record_length) {
                return Err(bad(format!("the header says {} points, {} more chunks follow the last of them", points, table.len() - i)));
            }
            break; // an empty last chunk, as some writers add
        }
        if n > left || entry.byte_count > table_start - offset {
            return Err(bad(format!("chunk table at byte {}: entry {} does not fit the file", table_start, i)));
        }
        if n.saturating_mul(record_length as u64) > LARGEST_CHUNK_BYTES {
            return Err(bad(format!("chunk {} of {} points is too large", i, n)));
        }
        if n > 0 {
            chunks.push(Chunk { offset, bytes: entry.byte_count as usize, points: n as usize });
        }
        offset += entry.byte_count;
        left -= n;
    }
    if left > 0 {
        return Err(bad(format!("the chunks hold {} points, the header says {}", points - left, points)));
    }
    Ok(Some(chunks))
}

/// Where what follows the points begins: waveforms, extended records, or the end of the file.
fn end_of_points(file: &mut File, data_start: u64) -> std::io::Result<u64> {
    let mut end = file.metadata()?.len();
    let minor = u64_at(file, 18)?.to_be_bytes()[0]; // byte 25
    for (at, since) in [(227, 3), (235, 4)] {
        let start = u64_at(file, at)?;
        if minor >= since && start >= data_start {
            end = end.min(start);
        }
    }
    Ok(end)
}

/// Do chunks of points follow? Where a killed writer never filled the offset of the chunk table, whatever lies behind it is one.
fn holds_chunks(file: &mut File, data_start: u64, smallest: u64) -> std::io::Result<bool> {
    let (size, end) = (file.metadata()?.len(), end_of_points(file, data_start)?);
    if end < data_start + 8 {
        return Ok(false); // without even an offset
    }
    let is_place = |at: &u64| (data_start + 8..=end).contains(at);
    // A writer that cannot seek puts the offset last.
    let table_start = [u64_at(file, data_start)?, u64_at(file, size - 8)?].into_iter().find(is_place).unwrap_or(end);
    Ok(table_start - data_start >= 8 + smallest)
}

/// Layers of a layered chunk.
fn layers_of(vlr: &LazVlr) -> usize {
    vlr.items()
        .iter()
        .map(|item| match item.item_type() {
            LazItemType::Point14 => 9,
            LazItemType::RGBNIR14 => 2,
            LazItemType::Byte14(n) => n as usize,
            _ => 1,
        })
        .sum()
}

/// Bytes of a chunk of one point at least; one of none may have a count and the sizes of its layers.
fn smallest_chunk(vlr: &LazVlr, record_length: usize) -> u64 {
    (record_length + if vlr_is_layered(vlr) { 4 + 4 * layers_of(vlr) } else { 0 }) as u64
}

/// A layered chunk: first record, point count, size of every layer, layers. Its sizes must fit before memory is taken for them.
fn check_layers(chunk: &[u8], points: usize, vlr: &LazVlr, record_length: usize) -> Result<()> {
    let layers = layers_of(vlr);
    let word = |i: usize| -> Result<u64> {
        let at = record_length + 4 * i;
        let b = chunk.get(at..at + 4).ok_or_else(|| bad("the data end too early"))?;
        Ok(u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])))
    };
    if word(0)? != points as u64 {
        return Err(bad(format!("it says {} points where {} should be", word(0)?, points)));
    }
    let mut total = (record_length + 4 + 4 * layers) as u64;
    for i in 1..=layers {
        total += word(i)?;
    }
    if total > chunk.len() as u64 {
        return Err(bad("its layers are longer than itself"));
    }
    Ok(())
}

fn decompressor_of<'a, S>(chunk: S, points: usize, vlr: &LazVlr, record_length: usize) -> Result<Box<dyn RecordDecompressor<Cursor<S>> + 'a>>
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
    decompressor.set_selection(laz::DecompressionSelection::all());
    Ok(decompressor)
}

fn decompress_chunk(chunk: &[u8], out: &mut [u8], vlr: &LazVlr, record_length: usize) -> Result<()> {
    decompressor_of(chunk, out.len() / record_length, vlr, record_length)?.decompress_many(out)?;
    Ok(())
}

fn in_chunk(number: usize, offset: u64, e: Error) -> Error {
    Error::new(e.code, format!("chunk {} at byte {}: {}", number, offset, e.message))
}

impl Reader {
    pub fn open(
        path: &Path,
        data_start: u64,
        vlr: LazVlr,
        point_format: u8,
        record_length: u16,
        points: u64,
        threads: u32,
    ) -> Result<Self> {
        check_items(&vlr, point_format, record_length)?;
        let mut file = File::open(path)?;
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
        let threads = Threads::new(threads)?;
        Ok(Self { source, large: None, vlr, record_length, left: points, threads, ready: Vec::new(), position: 0 })
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
            decompressor_of(compressed, chunk.points, &self.vlr, self.record_length).map_err(|e| in_chunk(*next, chunk.offset, e))?;
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
        file.seek(SeekFrom::Start(chunks[first].offset))?;
        file.read_exact(&mut compressed)?;
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
        let (vlr, record_length) = (&self.vlr, self.record_length);
        self.threads.map(jobs, |(i, offset, chunk_in, chunk_out)| {
            decompress_chunk(chunk_in, chunk_out, vlr, record_length)
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
