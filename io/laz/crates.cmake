# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DCARGO=... -DMANIFEST=... -DINTO=... -P crates.cmake: the crates of Cargo.lock into the folder INTO, with one repair.
#
# laz 0.13.0 reads the GPS times of point formats 6 to 10 by a function that calls itself whenever the stream switches to another of four
# sequences of times. A whole stream switches at most once for a time; a damaged one switches without end and overflows the stack. Beyond
# as many switches as there are sequences the repaired function reports a damaged stream.
set(sequences 4)

execute_process(COMMAND ${CARGO} vendor --locked --quiet --respect-source-config --manifest-path ${MANIFEST} ${INTO}
                OUTPUT_QUIET ERROR_VARIABLE fault RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "cargo vendor: ${fault}")
endif()

# The package's own checksum stays, which Cargo.lock holds; those of its single files go, one of which changes.
set(checksums ${INTO}/laz/.cargo-checksum.json)
file(READ ${checksums} listed)
if(NOT listed MATCHES "\"package\":\"([0-9a-f]+)\"")
  message(FATAL_ERROR "${checksums}: no checksum of the package")
endif()
file(WRITE ${checksums} "{\"files\":{},\"package\":\"${CMAKE_MATCH_1}\"}")

set(source ${INTO}/laz/src/las/point6.rs)
file(READ ${source} text)
set(head "fn read_gps_time(&mut self) -> std::io::Result<()> {")
set(again "                    self.read_gps_time()?;")  # within the function: deeper than the call from outside
string(FIND "${text}" "${head}" at_head)
string(REGEX MATCHALL "\n                    self\\.read_gps_time" calls "${text}")
list(LENGTH calls count)
if(at_head EQUAL -1 OR NOT count EQUAL 2)
  message(FATAL_ERROR "${source}: not the text that the repair of read_gps_time was written for; see whether this version of laz needs it")
endif()
string(REPLACE "\n${again}" "\n                    self.read_gps_time_after(switches + 1)?;" text "${text}")
string(REPLACE "${head}" "${head}
            self.read_gps_time_after(0)
        }
        fn read_gps_time_after(&mut self, switches: u8) -> std::io::Result<()> {
            if switches > ${sequences} {
                return Err(std::io::Error::new(std::io::ErrorKind::InvalidData, \"GPS times switch without end\"));
            }" text "${text}")
file(WRITE ${source} "${text}")
