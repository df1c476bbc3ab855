// SPDX-License-Identifier: GPL-3.0-or-later
//! What compressed points are read from: a file, or whatever the caller reads for us.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::os::raw::{c_int, c_void};

/// swath_laz_source of swath_laz.h.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Source {
    context: *mut c_void,
    size: u64,
    read: unsafe extern "C" fn(*mut c_void, u64, *mut u8, usize) -> c_int,
}

// One handle is for one thread at a time (swath_laz.h): the context goes where the handle goes, and is used through `&mut` alone.
unsafe impl Send for Source {}
unsafe impl Sync for Source {}

pub enum Input {
    File(File),
    Bytes { source: Source, position: u64 },
}

impl Input {
    pub fn of(source: Source) -> Self {
        Input::Bytes { source, position: 0 }
    }

    pub fn size(&self) -> io::Result<u64> {
        match self {
            Input::File(file) => Ok(file.metadata()?.len()),
            Input::Bytes { source, .. } => Ok(source.size),
        }
    }
}

impl Read for Input {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let (source, position) = match self {
            Input::File(file) => return file.read(out),
            Input::Bytes { source, position } => (source, position),
        };
        let n = (out.len() as u64).min(source.size.saturating_sub(*position)) as usize;
        if n == 0 {
            return Ok(0);
        }
        if unsafe { (source.read)(source.context, *position, out.as_mut_ptr(), n) } != 0 {
            return Err(io::Error::new(io::ErrorKind::Other, "the source cannot be read"));
        }
        *position += n as u64;
        Ok(n)
    }
}

impl Seek for Input {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let (source, position) = match self {
            Input::File(file) => return file.seek(to),
            Input::Bytes { source, position } => (source, position),
        };
        let place = match to {
            SeekFrom::Start(at) => i128::from(at),
            SeekFrom::End(by) => i128::from(source.size) + i128::from(by),
            SeekFrom::Current(by) => i128::from(*position) + i128::from(by),
        };
        *position = u64::try_from(place).map_err(|_| io::Error::new(io::ErrorKind::InvalidInput, "a place before the start"))?;
        Ok(*position)
    }
}
