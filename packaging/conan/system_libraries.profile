# What a system's own packages hold need not be built: Conan then leaves these to CMake.
include(default)

[settings]
compiler.cppstd=20

[platform_requires]
eigen/3.4.0
ceres-solver/2.1.0
nlopt/2.7.1
fmt/9.1.0
xsimd/8.1.0
nlohmann_json/3.11.2
zlib/1.2.13
zstd/1.5.4
