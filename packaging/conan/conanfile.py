# SPDX-License-Identifier: BSD-3-Clause
"""A recipe for Conan 2 of the checkout that it lies in.

Without options it packages sepcal::core, headers that need Eigen alone; engine=True adds the fits
of whole records, flight=True logs and calibrations in files. Those who use it find sepcal's own
CMake package, with its components, or its .pc files.
"""

import re
from pathlib import Path

from conan import ConanFile
from conan.errors import ConanInvalidConfiguration
from conan.tools.build import check_min_cppstd
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy

required_conan_version = ">=2.0"


class Sepcal(ConanFile):
    """Sepcal, of as many parts as the options say."""

    name = "sepcal"
    license = "BSD-3-Clause"
    description = "Calibrates aerospace sensors from flight data"
    topics = ("calibration", "estimation", "kalman-filter", "flight", "header-only")
    settings = "os", "arch", "compiler", "build_type"
    options = {"engine": [True, False], "flight": [True, False], "fPIC": [True, False]}  # noqa: RUF012
    default_options = {  # noqa: RUF012
        "engine": False,
        "flight": False,
        "fPIC": True,
        "ceres-solver/*:use_glog": True,  # a fit's log goes through it
    }

    def set_version(self) -> None:
        """The version of the project beside it."""
        text = (Path(self.recipe_folder) / "../../CMakeLists.txt").read_text()
        self.version = re.search(r"project\(\s*sepcal\s+VERSION\s+([0-9.]+)", text)[1]

    def export_sources(self) -> None:
        """What is needed to build, without tests and documents."""
        root = Path(self.recipe_folder).resolve().parents[1]
        for pattern in ("CMakeLists.txt", "LICENSE", "cpp/*"):
            copy(self, pattern, root, self.export_sources_folder)

    def configure(self) -> None:
        """Headers have no position."""
        if not self.options.engine:
            self.options.rm_safe("fPIC")

    def validate(self) -> None:
        """What the options need of one another and of the compiler."""
        if self.options.flight and not self.options.engine:
            raise ConanInvalidConfiguration("sepcal: flight=True needs engine=True")
        if self.settings.get_safe("compiler.cppstd"):
            check_min_cppstd(self, 20)

    def layout(self) -> None:
        """The project is two folders up."""
        self.folders.root = "../.."
        cmake_layout(self)

    def requirements(self) -> None:
        """The core needs Eigen alone."""
        self.requires("eigen/3.4.0", transitive_headers=True)
        if self.options.engine:
            self.requires("ceres-solver/2.1.0", transitive_headers=True, transitive_libs=True)
            self.requires("nlopt/2.7.1")
            self.requires("fmt/[>=9 <12]")
            self.requires("xsimd/[>=8.1 <14]")
        if self.options.flight:
            self.requires("nlohmann_json/[>=3.11 <4]")
            self.requires("zlib/[>=1.2 <2]")
            self.requires("zstd/[>=1.5 <2]")

    def generate(self) -> None:
        """As scripts/setup configures, of what the options say."""
        toolchain = CMakeToolchain(self)
        toolchain.user_presets_path = False  # the checkout stays as it is
        toolchain.cache_variables["SEPCAL_BUILD_ENGINE"] = bool(self.options.engine)
        toolchain.cache_variables["SEPCAL_BUILD_FLIGHT"] = bool(self.options.flight)
        toolchain.cache_variables["SEPCAL_BUILD_APPS"] = False
        toolchain.generate()
        CMakeDeps(self).generate()

    def build(self) -> None:
        """Of the core nothing is compiled."""
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self) -> None:
        """What cmake --install gives."""
        copy(self, "LICENSE", self.source_folder, Path(self.package_folder) / "licenses")
        CMake(self).install()

    def package_id(self) -> None:
        """Headers are the same for every compiler and processor."""
        if not self.info.options.engine:
            self.info.clear()

    def package_info(self) -> None:
        """CMake takes the package's own files; others take these components."""
        self.cpp_info.set_property("cmake_find_mode", "none")
        core = self.cpp_info.components["core"]
        core.set_property("pkg_config_name", "sepcal-core")
        core.defines = ["EIGEN_MAX_ALIGN_BYTES=64", "EIGEN_MAX_STATIC_ALIGN_BYTES=64"]
        core.requires = ["eigen::eigen"]
        core.builddirs = ["lib/cmake/sepcal"]
        core.libdirs = []
        core.bindirs = []
        if self.options.engine:
            others = ["ceres-solver::ceres-solver", "nlopt::nlopt"]
            self._archive("sepcal", "core", *others, "fmt::fmt", "xsimd::xsimd")
            self._archive("sepcal_states", "sepcal")
        if self.options.flight:
            json = "nlohmann_json::nlohmann_json"
            self._archive("sepcal_flight", "sepcal", json, "zlib::zlib", "zstd::zstd")
            self._archive("sepcal_simulation", "sepcal_flight")
            self._archive("sepcal_aircraft", "sepcal_states", "sepcal_simulation")

    def _archive(self, name: str, *requires: str) -> None:
        component = self.cpp_info.components[name]
        component.libs = [name]
        component.requires = list(requires)
        if self.settings.os == "Linux":
            component.system_libs = ["pthread", "m"]
