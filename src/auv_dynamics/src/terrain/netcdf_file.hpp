#pragma once

#include <optional>
#include <string>
#include <vector>

#include "netcdf_library.hpp"

namespace stg::dynamics {

/// An open NetCDF file for reading. Every error throws UserError with the file's name.
class NetcdfFile {
 public:
  explicit NetcdfFile(const std::string& path);
  ~NetcdfFile();
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  struct Variable {
    int id = -1;
    std::string name;
    std::vector<int> dimensions;
    bool numeric = false;
  };
  struct Dimension {
    std::string name;
    std::size_t size = 0;
  };
  std::vector<Variable> Variables() const;
  Dimension DimensionOf(int id) const;
  std::optional<std::string> Text(const Variable& variable, const char* attribute) const;
  std::optional<double> Number(const Variable& variable, const char* attribute) const;
  /// Raw values of a part, as doubles or floats.
  std::vector<double> Doubles(const Variable& variable, std::size_t count) const;
  std::vector<float> Floats(const Variable& variable, const std::size_t (&start)[2],
                            const std::size_t (&count)[2]) const;

  [[noreturn]] void Refuse(const std::string& what) const;

 private:
  void Check(int status, const char* doing) const;

  const std::unique_lock<std::mutex> lock_ = NetcdfLibrary::Lock();
  const NetcdfLibrary& netcdf_;
  std::string path_;
  int id_ = -1;
};

}  // namespace stg::dynamics
