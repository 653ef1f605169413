# SPDX-License-Identifier: BSD-3-Clause
"""Builds and runs, against the package, the consumer that the other installations have too."""

from pathlib import Path

from conan import ConanFile
from conan.tools.build import can_run
from conan.tools.cmake import CMake, cmake_layout


class SepcalConsumer(ConanFile):
    """Flight software with the core alone."""

    settings = "os", "arch", "compiler", "build_type"
    generators = "CMakeToolchain", "CMakeDeps"

    def requirements(self) -> None:
        """The package that is tried."""
        self.requires(self.tested_reference_str)

    def layout(self) -> None:
        """As CMake has it."""
        cmake_layout(self)

    def build(self) -> None:
        """By find_package(sepcal COMPONENTS core)."""
        consumer = Path(self.recipe_folder).resolve().parents[2] / "tests/consumer/core"
        cmake = CMake(self)
        cmake.configure(build_script_folder=str(consumer))
        cmake.build()

    def test(self) -> None:
        """Its exit status tells how many answers are wrong."""
        if can_run(self):
            self.run(str(Path(self.cpp.build.bindir, "core_consumer").absolute()), env="conanrun")
