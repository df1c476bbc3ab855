// SPDX-License-Identifier: GPL-3.0-or-later
//! Codes of swath_laz.h with a message.

pub const DATA: i32 = 1;
pub const FILE: i32 = 2;
pub const USAGE: i32 = 3;
pub const PANIC: i32 = 4;

pub struct Error {
    pub code: i32,
    pub message: String,
}

pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    pub fn new(code: i32, message: impl Into<String>) -> Self {
        Self { code, message: message.into() }
    }
}

/// A compressed stream that ends early is bad data; every other failure of reading or writing is the file's.
impl From<std::io::Error> for Error {
    fn from(e: std::io::Error) -> Self {
        match e.kind() {
            std::io::ErrorKind::UnexpectedEof | std::io::ErrorKind::InvalidData => Error::new(DATA, "the data end too early"),
            _ => Error::new(FILE, e.to_string()),
        }
    }
}

impl From<laz::LasZipError> for Error {
    fn from(e: laz::LasZipError) -> Self {
        match e {
            laz::LasZipError::IoError(e) => e.into(),
            other => Error::new(DATA, other.to_string()),
        }
    }
}
