# SPDX-License-Identifier: GPL-3.0-or-later
"""What a wheel adds: its own PROJ database and typeface, where the system or the user has none. scripts/test_packages.sh installs whole wheels."""
import os
import subprocess
import sys
import unittest

from support import InFolder

import _swath_command

from swath import _wheel


class Wheel(InFolder):
    def setUp(self):
        super().setUp()
        self.share = self.folder / "share"
        for file in ("share/proj/proj.db", "share/swath/fonts/fonts.conf", "theirs/proj.db", "grids/own.gtx"):
            (self.folder / file).parent.mkdir(parents=True, exist_ok=True)
            (self.folder / file).write_text("")
        self.own, self.grids, self.theirs = (str(self.folder / n) for n in ("share/proj", "grids", "theirs"))

    def test_proj_finds_the_database_of_the_wheel_and_grids_of_the_user(self):
        folders = lambda environment: _wheel.proj_folders(environment, self.share)
        self.assertEqual(folders({}), [self.own])
        self.assertEqual(folders({"PROJ_DATA": self.grids}), [self.grids, self.own])
        self.assertEqual(folders({"PROJ_LIB": self.grids}), [self.grids, self.own])
        self.assertEqual(folders({"PROJ_DATA": os.pathsep.join([self.grids, self.theirs])}), [], "a database that the user names is taken")
        self.assertEqual(_wheel.proj_folders({}, self.folder / "none"), [], "a build from source")
        self.assertEqual(_wheel.users_proj_folder({"HOME": "/home/a"}), "/home/a/.local/share/proj")
        self.assertEqual(_wheel.users_proj_folder({"HOME": "/home/a", "XDG_DATA_HOME": "/data"}), "/data/proj")
        self.assertEqual(_wheel.users_proj_folder({}), "")

    def test_the_programs_environment(self):
        environment_of = lambda environment: _swath_command.environment_of(environment, self.folder)
        self.assertEqual(environment_of({"PROJ_DATA": self.grids, "A": "b"}), {"PROJ_DATA": os.pathsep.join([self.grids, self.own]), "A": "b"})
        self.assertEqual(environment_of({"PROJ_DATA": self.theirs}), {"PROJ_DATA": self.theirs})

    def test_the_program_starts_without_the_package(self):
        done = subprocess.run([sys.executable, "-c", "import _swath_command, sys; print('numpy' in sys.modules or 'swath' in sys.modules)"],
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout.strip(), "False")

    def test_the_typeface_is_that_of_the_system_where_it_has_one(self):
        system = self.folder / "system.conf"
        own = str(self.share / "swath/fonts/fonts.conf")
        self.assertEqual(_wheel.typeface({}, self.share, system), own)
        self.assertEqual(_wheel.typeface({"FONTCONFIG_FILE": "mine.conf"}, self.share, system), "")
        system.write_text("")
        self.assertEqual(_wheel.typeface({}, self.share, system), "")
        self.assertEqual(_wheel.typeface({}, self.folder / "none", self.folder / "none.conf"), "")


if __name__ == "__main__":
    unittest.main()
