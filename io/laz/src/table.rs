// SPDX-License-Identifier: GPL-3.0-or-later
//! Where the chunks of a file are and how large they may be, held against the file before memory is taken for them.

use std::io::{BufReader, Read, Seek, SeekFrom};

use laz::laszip::{ChunkTable, CompressorType, LazItemType};
use laz::{LazItemRecordBuilder, LazVlr};

use crate::error::{Error, Result, DATA};
use crate::input::Input;

pub const LARGEST_CHUNK_BYTES: u64 = 1 << 30;

pub struct Chunk {
    pub offset: u64,
    pub bytes: usize,
    pub points: usize,
}

pub fn bad(message: impl Into<String>) -> Error {
    Error::new(DATA, message)
}

/// The VLR must describe exactly the records of the point format.
pub fn check_items(vlr: &LazVlr, point_format: u8, record_length: u16) -> Result<()> {
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

pub fn vlr_is_layered(vlr: &LazVlr) -> bool {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).is_ok() && bytes[0] == CompressorType::LayeredChunked as u8
}

pub fn vlr_is_pointwise(vlr: &LazVlr) -> bool {
    let mut bytes = Vec::new();
    vlr.write_to(&mut bytes).is_ok() && bytes[0] == CompressorType::PointWise as u8
}

pub fn u64_at(file: &mut Input, at: u64) -> std::io::Result<u64> {
    let mut b = [0u8; 8];
    file.seek(SeekFrom::Start(at))?;
    file.read_exact(&mut b)?;
    Ok(u64::from_le_bytes(b))
}

/// Reads the table and holds every number in it against the file. None: the writer never filled its offset.
pub fn read_table(file: &mut Input, data_start: u64, vlr: &LazVlr, record_length: usize, points: u64) -> Result<Option<Vec<Chunk>>> {
    let file_size = file.size()?;
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
pub fn end_of_points(file: &mut Input, data_start: u64) -> std::io::Result<u64> {
    let mut end = file.size()?;
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
pub fn holds_chunks(file: &mut Input, data_start: u64, smallest: u64) -> std::io::Result<bool> {
    let (size, end) = (file.size()?, end_of_points(file, data_start)?);
    if end < data_start + 8 {
        return Ok(false); // without even an offset
    }
    let is_place = |at: &u64| (data_start + 8..=end).contains(at);
    // A writer that cannot seek puts the offset last.
    let table_start = [u64_at(file, data_start)?, u64_at(file, size - 8)?].into_iter().find(is_place).unwrap_or(end);
    Ok(table_start - data_start >= 8 + smallest)
}

/// Layers of a layered chunk.
pub fn layers_of(vlr: &LazVlr) -> usize {
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
pub fn smallest_chunk(vlr: &LazVlr, record_length: usize) -> u64 {
    (record_length + if vlr_is_layered(vlr) { 4 + 4 * layers_of(vlr) } else { 0 }) as u64
}

/// A layered chunk: first record, point count, size of every layer, layers. Its sizes must fit before memory is taken for them.
pub fn check_layers(chunk: &[u8], points: usize, vlr: &LazVlr, record_length: usize) -> Result<()> {
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
