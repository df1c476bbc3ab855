# SPDX-License-Identifier: GPL-3.0-or-later
"""Airborne laser surveys: raw records to trajectories, georeferenced and classified points, terrain models and contours.

Points are NumPy columns by LAS names; every filter and surface of the program `swath` is a function on them, with its options by name and
numbers with their units as text (cell="50 cm"). Pipeline runs whole surveys. What is wrong raises swath.Error.
"""

import os as _os

from . import _swath, _wheel
from ._errors import Error
from ._flight import Trajectory, georeference, read_survey, read_trajectory, simulate, smooth
from ._functions import FUNCTIONS
from ._other import describe_file, stages
from ._pipeline import Pipeline, Tile
from ._points import Points, Storage, as_points, read_points, write_points
from ._report import Report, Stage, read_report
from ._surfaces import VOIDS, Contour, Contours, Grid, read_grid
from ._swath import version as __version__

globals().update(FUNCTIONS)
if _folders := _wheel.proj_folders(_os.environ):
    # Within this module alone: other packages' PROJ, and the environment that they read, are left as they are.
    _swath.use_proj_folders([_wheel.users_proj_folder(_os.environ), *_folders])
if _settings := _wheel.typeface(_os.environ):
    _os.environ["FONTCONFIG_FILE"] = _settings
__all__ = ["VOIDS", "Contour", "Contours", "Error", "Grid", "Pipeline", "Points", "Report", "Stage", "Storage", "Tile", "Trajectory", "as_points",
           "describe_file", "georeference", "read_grid", "read_points", "read_report", "read_survey", "read_trajectory", "simulate", "smooth",
           "stages", "write_points", "__version__", *FUNCTIONS]
