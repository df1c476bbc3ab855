// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/registry.h"

#include "stages/adapters/adapters.h"
#include "stages/adapters/calibration/calibration_flight.h"
#include "stages/adapters/calibration/calibrations.h"
#include "stages/adapters/calibration/geometry.h"
#include "stages/adapters/calibration/strips.h"
#include "stages/adapters/flight/hangar.h"
#include "stages/adapters/flight/ins_gnss.h"
#include "stages/adapters/flight/kinematic.h"
#include "stages/adapters/flight/navigation.h"
#include "stages/adapters/flight/rtklib.h"
#include "stages/adapters/flight/time_sync.h"
#include "stages/tile_filter.h"

namespace swath::stages {

const std::vector<Entry>& registry() {
  static const std::vector<Entry> list = {
      once<solve_baselines>("gnss.rtklib",
                            "Antenna positions from raw GNSS observations of the aircraft and of base stations, by RTKLIB's rnx2rtkp.",
                            {.check = expect_rinex, .inputs = rinex_files, .products = rtklib_products}),
      once<read_trajectory>("readers.trajectory",
                            "Reads the survey's trajectory and judges it: gaps, repeated times, heading against track.",
                            {.check = expect_trajectory, .inputs = trajectory_inputs}),
      once<read_imu>("readers.imu", "Reads the survey's IMU records as increments in body axes.",
                     {.check = expect_imu, .inputs = imu_files}),
      once<read_gnss>("readers.gnss", "Reads the survey's GNSS positions (text, RTKLIB, NMEA).",
                      {.check = expect_gnss, .inputs = gnss_files}),
      once<smooth_flight>(
          "trajectory.ins_gnss",
          "Smoothed trajectory from IMU and GNSS records: strapdown mechanisation, error-state Kalman filter, smoother; with "
          "its covariances, estimates of the sensors' errors and plots.",
          {.check = expect_imu_spec, .inputs = true_trajectory, .products = ins_gnss_products}),
      once<sync_times>("time.sync",
                       "Brings events to GPS time: corrects those of the computer's clock by its logs, flags doubtful ones, compares "
                       "techniques.",
                       {.check = expect_events, .inputs = event_files, .products = time_sync_products}),
      once<position_events>("trajectory.kinematic",
                            "Positions of the GNSS antenna at events, by a Kalman filter from both sides; leave-one-out test.",
                            {.check = expect_crs, .products = kinematic_products}),
      once<survey_hangar>("calib.lever_arm",
                          "Lever arms of IMU, scanner and antenna by a hangar survey with a total station, with their covariance.",
                          {.check = expect_hangar, .inputs = hangar_files, .products = lever_arm_files}),
      {"readers.laser", make_laser_reader},
      {"readers.las", make_las_reader},
      once<adjust_flight>("calib.adjust",
                          "Rigorous adjustment of a calibration flight: boresight, range and scan corrections and the trajectory's line "
                          "corrections from planes "
                          "that several lines have seen; calibration.json and report.html.",
                          {.inputs = control_files, .products = adjust_products}),
      once<measure_flat_target>(
          "calib.flat_target",
          "Calibration flight over a flat roof: its displacement in each line, and from it pitch, roll, heading and range "
          "offset, each from its own passes.",
          {.inputs = control_files, .products = flat_target_products}),
      once<correct_strips>("calib.strips",
                           "Strip adjustment: corrects the trajectory of a survey along its lines so that they meet on planes that several "
                           "of them have seen, the calibration held; strips.json and report.html.",
                           {.inputs = control_files, .products = strip_products}),
      once<judge_flight>("quality.geometry",
                         "Judges the geometry of a flight on a sample of its returns: lines against one another, heights, headings, roll; "
                         "where they do not fit, the usual mistakes are tried.",
                         {.inputs = control_files}),
      {"georeference", make_georeference},
      {"filters.returns", make_returns},
      class_filter<filters::flag_noise>(
          "filters.noise", "Isolated points, low points and ranges outside the gate: flagged and classed as noise, never deleted.",
          {.check = expect_ranges}),
      class_filter<filters::flag_outliers>(
          "filters.outlier",
          "Statistical outliers and small groups alone in space (birds, scraps of cloud, multipath): flagged and classed as "
          "noise, never deleted."),
      {"filters.visibility", make_visibility},
      {"quality.lines", make_lines},
      ground_filter<filters::classify_ground_smrf>("filters.smrf",
                                                   "Ground points by the Simple Morphological Filter (Pingel, Clarke and McBride 2013)."),
      ground_filter<filters::classify_ground_ptd>("filters.ptd", "Ground points by progressive TIN densification (Axelsson 2000)."),
      ground_filter<filters::classify_ground_robust>(
          "filters.robust", "Ground points by hierarchic robust interpolation (Kraus and Pfeifer 1998; Pfeifer et al. 2001)."),
      ground_filter<filters::classify_ground_pmf>("filters.pmf",
                                                  "Ground points by the progressive morphological filter (Zhang et al. 2003)."),
      ground_filter<filters::classify_ground_csf>("filters.csf", "Ground points by cloth simulation (Zhang et al. 2016)."),
      {"filters.ground", make_ground},
      class_filter<filters::classify_water>(
          "filters.water", "Water (class 9) by level returns where most pulses do not come back; between a ground filter and the terrain."),
      {"filters.hag_dem", make_hag_dem},
      class_filter<filters::classify>("filters.classify",
                                      "Classes of what is not ground: low, medium and high vegetation, buildings, wires, bridge decks."),
      filter<terrain::mark_key_points>(
          "filters.key_points", "Model key points: flags the ground points whose triangulation stays within a tolerance of all of them."),
      {"terrain.breaklines", make_breaklines},
      {"terrain.dtm", make_dtm},
      {"terrain.dsm", make_dsm},
      {"terrain.canopy", make_canopy},
      {"terrain.relief", make_relief},
      {"terrain.density", make_density},
      {"terrain.intensity", make_intensity},
      {"terrain.contours", make_contours},
      {"terrain.penetration", make_penetration},
      once<write_trajectory>("writers.trajectory", "Trajectory as SBET with smrmsg and as delimited text with its covariances.",
                             {.products = trajectory_products}),
      {"writers.las", make_las_writer},
      {"writers.gdal", make_gdal_writer},
      {"writers.picture", make_picture_writer},
      {"report.truth", make_truth},
  };
  return list;
}

std::unique_ptr<Stage> make_stage(std::string_view name) {
  for (const Entry& e : registry())
    if (e.name == name) return e.make();
  return nullptr;
}

}  // namespace swath::stages
