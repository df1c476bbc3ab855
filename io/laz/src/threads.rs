// SPDX-License-Identifier: GPL-3.0-or-later
//! Chunks are independent: work on several of them at once, results in their order.

use rayon::prelude::*;

use crate::error::{Error, Result, FILE};

pub enum Threads {
    Caller,
    Shared,
    Own(rayon::ThreadPool),
}

impl Threads {
    pub fn new(threads: u32) -> Result<Self> {
        Ok(match threads {
            0 => Threads::Shared,
            1 => Threads::Caller,
            n => Threads::Own(
                rayon::ThreadPoolBuilder::new()
                    .num_threads(n as usize)
                    .build()
                    .map_err(|e| Error::new(FILE, format!("cannot start threads: {}", e)))?,
            ),
        })
    }

    pub fn count(&self) -> usize {
        match self {
            Threads::Caller => 1,
            Threads::Shared => rayon::current_num_threads(),
            Threads::Own(pool) => pool.current_num_threads(),
        }
    }

    /// `f` of each job; the results in the order of the jobs, or the error of the first job that has one.
    pub fn map<J: Send, T: Send>(&self, jobs: Vec<J>, f: impl Fn(J) -> Result<T> + Sync + Send) -> Result<Vec<T>> {
        let results: Vec<Result<T>> = match self {
            Threads::Caller => return jobs.into_iter().map(f).collect(),
            Threads::Shared => jobs.into_par_iter().map(f).collect(),
            Threads::Own(pool) => pool.install(|| jobs.into_par_iter().map(f).collect()),
        };
        results.into_iter().collect()
    }
}
