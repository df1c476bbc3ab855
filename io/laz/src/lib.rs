// SPDX-License-Identifier: GPL-3.0-or-later
//! The C border of swath_laz.h: pointers in, codes and messages out. No panic crosses it.

mod error;
mod input;
mod reader;
mod table;
mod threads;
mod writer;

use std::ffi::{CStr, OsStr};
use std::fs::File;
use std::os::raw::{c_char, c_int};
use std::os::unix::ffi::OsStrExt;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

use error::{Error, Result, DATA, PANIC, USAGE};
use input::{Input, Source};
use reader::Reader;
use writer::Writer;

/// Runs `f`, turns errors and panics into a code and a message.
unsafe fn guarded(message: *mut c_char, capacity: usize, f: impl FnOnce() -> Result<()>) -> c_int {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| std::panic::set_hook(Box::new(|_| {}))); // a library never prints
    let error = match catch_unwind(AssertUnwindSafe(f)) {
        Ok(Ok(())) => return 0,
        Ok(Err(e)) => e,
        Err(panic) => {
            let text = panic
                .downcast_ref::<String>()
                .map(String::as_str)
                .or_else(|| panic.downcast_ref::<&str>().copied())
                .unwrap_or("unknown reason");
            Error::new(PANIC, format!("decoder stopped: {}", text))
        }
    };
    if !message.is_null() && capacity > 0 {
        let n = error.message.len().min(capacity - 1);
        std::ptr::copy_nonoverlapping(error.message.as_ptr(), message as *mut u8, n);
        *message.add(n) = 0;
    }
    error.code
}

unsafe fn path_of<'a>(path: *const c_char) -> &'a Path {
    Path::new(OsStr::from_bytes(CStr::from_ptr(path).to_bytes()))
}

unsafe fn input_of(path: *const c_char, source: *const Source) -> Result<Input> {
    if source.is_null() {
        return Ok(Input::File(File::open(path_of(path))?));
    }
    Ok(Input::of(*source))
}

unsafe fn slice_of<'a, T>(data: *const T, n: usize) -> &'a [T] {
    if n == 0 {
        &[]
    } else {
        std::slice::from_raw_parts(data, n)
    }
}

unsafe fn slice_mut_of<'a, T>(data: *mut T, n: usize) -> &'a mut [T] {
    if n == 0 {
        &mut []
    } else {
        std::slice::from_raw_parts_mut(data, n)
    }
}

unsafe fn vlr_of(data: *const u8, n: usize) -> Result<laz::LazVlr> {
    laz::LazVlr::from_buffer(slice_of(data, n)).map_err(|e| Error::new(DATA, format!("laszip VLR: {}", e)))
}

fn bytes_of(points: u64, record_length: usize) -> Result<usize> {
    usize::try_from(points)
        .ok()
        .and_then(|n| n.checked_mul(record_length))
        .ok_or_else(|| Error::new(USAGE, "too many points in one call"))
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_vlr(
    point_format: u8,
    extra_bytes: u16,
    chunk_points: u32,
    out: *mut u8,
    capacity: usize,
    size: *mut usize,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let vlr = writer::make_vlr(point_format, extra_bytes, chunk_points)?;
        *size = vlr.len();
        if vlr.len() > capacity {
            return Err(Error::new(USAGE, "buffer too small for the laszip VLR"));
        }
        slice_mut_of(out, vlr.len()).copy_from_slice(&vlr);
        Ok(())
    })
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_reader_open(
    path: *const c_char,
    source: *const Source,
    data_start: u64,
    vlr: *const u8,
    vlr_size: usize,
    point_format: u8,
    record_length: u16,
    point_count: u64,
    threads: u32,
    reader: *mut *mut Reader,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let vlr = vlr_of(vlr, vlr_size)?;
        let opened = Reader::open(input_of(path, source)?, data_start, vlr, point_format, record_length, point_count, threads)?;
        *reader = Box::into_raw(Box::new(opened));
        Ok(())
    })
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_reader_open_chunks(
    path: *const c_char,
    source: *const Source,
    vlr: *const u8,
    vlr_size: usize,
    point_format: u8,
    record_length: u16,
    offsets: *const u64,
    bytes: *const u64,
    points: *const u64,
    chunks: usize,
    threads: u32,
    reader: *mut *mut Reader,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let vlr = vlr_of(vlr, vlr_size)?;
        let (offsets, bytes, points) = (slice_of(offsets, chunks), slice_of(bytes, chunks), slice_of(points, chunks));
        let places = (0..chunks).map(|i| (offsets[i], bytes[i], points[i]));
        let opened = Reader::open_chunks(input_of(path, source)?, vlr, point_format, record_length, places, threads)?;
        *reader = Box::into_raw(Box::new(opened));
        Ok(())
    })
}

/// # Safety
/// A handle of swath_laz_reader_open.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_reader_select(reader: *mut Reader, fields: u32) {
    (*reader).select(fields);
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_reader_read(
    reader: *mut Reader,
    out: *mut u8,
    n: u64,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let reader = &mut *reader;
        let bytes = bytes_of(n, reader.record_length())?;
        reader.read(slice_mut_of(out, bytes))
    })
}

/// # Safety
/// A handle of swath_laz_reader_open, or null.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_reader_close(reader: *mut Reader) {
    if !reader.is_null() {
        let _ = catch_unwind(AssertUnwindSafe(|| drop(Box::from_raw(reader))));
    }
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_writer_open(
    path: *const c_char,
    position: u64,
    vlr: *const u8,
    vlr_size: usize,
    threads: u32,
    writer: *mut *mut Writer,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let opened = Writer::open(path_of(path), position, vlr_of(vlr, vlr_size)?, threads)?;
        *writer = Box::into_raw(Box::new(opened));
        Ok(())
    })
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_writer_write(
    writer: *mut Writer,
    points: *const u8,
    n: u64,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let writer = &mut *writer;
        let bytes = bytes_of(n, writer.record_length())?;
        writer.write(slice_of(points, bytes))
    })
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_writer_write_chunks(
    writer: *mut Writer,
    points: *const u8,
    counts: *const u64,
    chunks: usize,
    offsets: *mut u64,
    bytes: *mut u64,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        let writer = &mut *writer;
        let counts = slice_of(counts, chunks);
        let total = counts
            .iter()
            .try_fold(0u64, |sum, n| sum.checked_add(*n))
            .ok_or_else(|| Error::new(USAGE, "too many points in one call"))?;
        let points = slice_of(points, bytes_of(total, writer.record_length())?);
        writer.write_chunks(points, counts, slice_mut_of(offsets, chunks), slice_mut_of(bytes, chunks))
    })
}

/// # Safety
/// Pointers as swath_laz.h says.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_writer_finish(
    writer: *mut Writer,
    end: *mut u64,
    message: *mut c_char,
    message_capacity: usize,
) -> c_int {
    guarded(message, message_capacity, || {
        *end = (*writer).finish()?;
        Ok(())
    })
}

/// # Safety
/// A handle of swath_laz_writer_open, or null.
#[no_mangle]
pub unsafe extern "C" fn swath_laz_writer_close(writer: *mut Writer) {
    if !writer.is_null() {
        let _ = catch_unwind(AssertUnwindSafe(|| drop(Box::from_raw(writer))));
    }
}
