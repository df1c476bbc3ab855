// SPDX-License-Identifier: GPL-3.0-or-later
//! Compressing: every chunk alone into memory, several at once, written in order.

use std::fs::{File, OpenOptions};
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use laz::laszip::{ChunkTable, ChunkTableEntry};
use laz::record::{LayeredPointRecordCompressor, RecordCompressor, SequentialPointRecordCompressor};
use laz::{LazVlr, LazVlrBuilder};

use crate::error::{Error, Result, USAGE};
use crate::threads::Threads;

pub fn make_vlr(point_format: u8, extra_bytes: u16, chunk_points: u32) -> Result<Vec<u8>> {
    let builder = LazVlrBuilder::default().with_point_format(point_format, extra_bytes)?;
    let vlr = match chunk_points {
        0 => builder.with_variable_chunk_size(),
        n => builder.with_fixed_chunk_size(n),
    }
    .build();
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes)?;
    Ok(bytes)
}

fn compress_chunk(points: &[u8], vlr: &LazVlr, record_length: usize) -> Result<Vec<u8>> {
    let layered = vlr.items()[0].version() >= 3;
    let out = Vec::with_capacity(points.len() / 4);
    let mut compressor: Box<dyn RecordCompressor<Vec<u8>>> = if layered {
        Box::new(LayeredPointRecordCompressor::new(out))
    } else {
        Box::new(SequentialPointRecordCompressor::new(out))
    };
    compressor.set_fields_from(vlr.items())?;
    for point in points.chunks_exact(record_length) {
        compressor.compress_next(point)?;
    }
    compressor.done()?;
    Ok(compressor.box_into_inner())
}

pub struct Writer {
    out: BufWriter<File>,
    vlr: LazVlr,
    record_length: usize,
    threads: Threads,
    start: u64,
    end: u64,
    table: ChunkTable,
    waiting: Vec<u8>,
}

impl Writer {
    pub fn open(path: &Path, position: u64, vlr: LazVlr, threads: u32) -> Result<Self> {
        let record_length = vlr.items_size() as usize;
        if record_length == 0 {
            return Err(Error::new(USAGE, "laszip VLR without items"));
        }
        let mut out = BufWriter::with_capacity(1 << 20, OpenOptions::new().write(true).open(path)?);
        out.seek(SeekFrom::Start(position))?;
        out.write_all(&(-1i64).to_le_bytes())?;
        Ok(Self {
            out,
            vlr,
            record_length,
            threads: Threads::new(threads)?,
            start: position,
            end: position + 8,
            table: ChunkTable::default(),
            waiting: Vec::new(),
        })
    }

    pub fn record_length(&self) -> usize {
        self.record_length
    }

    /// Compresses the chunks and appends them; calls `placed(index, offset, bytes)` for each.
    fn append(
        out: &mut BufWriter<File>,
        end: &mut u64,
        table: &mut ChunkTable,
        record_length: usize,
        chunks: &[&[u8]],
        compressed: Vec<Vec<u8>>,
        mut placed: impl FnMut(usize, u64, u64),
    ) -> Result<()> {
        for (i, (points, bytes)) in chunks.iter().zip(compressed).enumerate() {
            out.write_all(&bytes)?;
            let byte_count = bytes.len() as u64;
            table.push(ChunkTableEntry { point_count: (points.len() / record_length) as u64, byte_count });
            placed(i, *end, byte_count);
            *end += byte_count;
        }
        Ok(())
    }

    /// Compresses waiting points: whole chunks, or all of them at the end.
    fn compress_waiting(&mut self, all: bool) -> Result<()> {
        let chunk = self.vlr.chunk_size() as usize * self.record_length;
        let whole = if all { self.waiting.len() } else { self.waiting.len() / chunk * chunk };
        let chunks: Vec<&[u8]> = self.waiting[..whole].chunks(chunk).collect();
        let (vlr, record_length) = (&self.vlr, self.record_length);
        let compressed = self.threads.map(chunks.clone(), |points| compress_chunk(points, vlr, record_length))?;
        Self::append(&mut self.out, &mut self.end, &mut self.table, record_length, &chunks, compressed, |_, _, _| {})?;
        self.waiting.drain(..whole);
        Ok(())
    }

    pub fn write(&mut self, mut points: &[u8]) -> Result<()> {
        if self.vlr.uses_variable_size_chunks() {
            return Err(Error::new(USAGE, "chunks of variable size are written one by one"));
        }
        let room = self.vlr.chunk_size() as usize * self.record_length * self.threads.count();
        while !points.is_empty() {
            let n = points.len().min(room - self.waiting.len());
            self.waiting.extend_from_slice(&points[..n]);
            points = &points[n..];
            if self.waiting.len() == room {
                self.compress_waiting(false)?;
            }
        }
        Ok(())
    }

    pub fn write_chunks(&mut self, points: &[u8], counts: &[u64], offsets: &mut [u64], bytes: &mut [u64]) -> Result<()> {
        if !self.vlr.uses_variable_size_chunks() {
            return Err(Error::new(USAGE, "chunks of fixed size are cut by the writer"));
        }
        if counts.contains(&0) {
            return Err(Error::new(USAGE, "a chunk holds at least one point"));
        }
        let mut chunks = Vec::with_capacity(counts.len());
        let mut rest = points;
        for count in counts {
            let (head, tail) = rest.split_at(*count as usize * self.record_length);
            chunks.push(head);
            rest = tail;
        }
        let (vlr, record_length) = (&self.vlr, self.record_length);
        let compressed = self.threads.map(chunks.clone(), |points| compress_chunk(points, vlr, record_length))?;
        Self::append(&mut self.out, &mut self.end, &mut self.table, record_length, &chunks, compressed, |i, offset, size| {
            offsets[i] = offset;
            bytes[i] = size;
        })
    }

    pub fn finish(&mut self) -> Result<u64> {
        if !self.waiting.is_empty() {
            self.compress_waiting(true)?;
        }
        self.table.write_to(&mut self.out, &self.vlr)?;
        let end = self.out.stream_position()?;
        self.out.seek(SeekFrom::Start(self.start))?;
        self.out.write_all(&(self.end as i64).to_le_bytes())?;
        self.out.flush()?;
        Ok(end)
    }
}
