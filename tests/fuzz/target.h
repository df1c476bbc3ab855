// SPDX-License-Identifier: GPL-3.0-or-later
// What the fuzz targets share. A target gives its reader one input and holds it to three things: nothing but core::Error is thrown, what
// is accepted has no NaN, no infinite and no far value, and no sanitizer reports a fault. Hangs and memory are libFuzzer's to judge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "core/records/gnss_data.h"
#include "core/records/imu_data.h"
#include "core/records/trajectory_data.h"
#include "io/survey/survey.h"

namespace swath::fuzz {

/// Points, records or cells of one input that are looked at: a few bytes may stand for gigabytes, which a reader hands out in batches.
constexpr std::size_t most_values = 200'000;

/// The folder of this process, in memory; it goes when the process ends.
const std::filesystem::path& folder();

/// Writes the input under a name in folder().
std::filesystem::path given(const std::string& name, const std::uint8_t* data, std::size_t size);

/// Calls a reader; a refusal is as good as an answer.
void reading(const std::function<void()>& reader);

/// Ends the process as a finding where the value is not finite or its size beyond `most`.
void expect(double value, double most, const char* what);

/// A survey of [[tables]] whose files lie in folder(); it is not checked against them.
io::Survey survey_of(const std::string& tables);

void expect_sound(const core::TrajectoryData& trajectory);
void expect_sound(const core::GnssData& gnss);
void expect_sound(const core::ImuData& imu);
/// Reads all shots of the survey's first laser file, and holds them to what LaserSource says.
void read_shots(const io::Survey& survey);

}  // namespace swath::fuzz
