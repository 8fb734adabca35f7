#include "netcdf_file.hpp"

#include <filesystem>

#include "auv_common/error.hpp"
#include "auv_common/regular_file.hpp"
#include "classic_header.hpp"

namespace stg::dynamics {
namespace {

/// Longer attributes are not units or names.
constexpr std::size_t kLongestText = 4096;

}  // namespace

NetcdfFile::NetcdfFile(const std::string& path) : netcdf_(NetcdfLibrary::Get()), path_(path) {
  // libnetcdf also accepts network addresses; only files are allowed here.
  RequireRegularFile(path);
  if (std::filesystem::file_size(path) == 0) throw UserError(path + ": is empty");
  const auto least = SmallestClassicSize(path);
  if (least && std::filesystem::file_size(path) < *least) {
    Refuse("damaged: " + std::to_string(std::filesystem::file_size(path)) +
           " bytes instead of at least " + std::to_string(*least));
  }
  Check(netcdf_.open(path.c_str(), NC_NOWRITE, &id_), "not a readable NetCDF file");
}

NetcdfFile::~NetcdfFile() {
  if (id_ >= 0) netcdf_.close(id_);
}

void NetcdfFile::Refuse(const std::string& what) const { throw UserError(path_ + ": " + what); }

void NetcdfFile::Check(int status, const char* doing) const {
  if (status != NC_NOERR) Refuse(std::string(doing) + " (" + netcdf_.strerror(status) + ")");
}

std::vector<NetcdfFile::Variable> NetcdfFile::Variables() const {
  int count = 0;
  Check(netcdf_.inq_nvars(id_, &count), "its variables cannot be read");
  std::vector<Variable> variables;
  for (int id = 0; id < count; ++id) {
    char name[NC_MAX_NAME + 1] = {};
    nc_type type = NC_NAT;
    int dimensions = 0;
    Check(netcdf_.inq_var(id_, id, name, &type, &dimensions, nullptr, nullptr),
          "a variable cannot be read");
    Variable& v = variables.emplace_back();
    v.id = id;
    v.name = name;
    v.numeric = type != NC_CHAR && type != NC_STRING && type <= NC_MAX_ATOMIC_TYPE;
    v.dimensions.resize(static_cast<std::size_t>(dimensions));
    Check(netcdf_.inq_vardimid(id_, id, v.dimensions.data()), "a variable cannot be read");
  }
  return variables;
}

NetcdfFile::Dimension NetcdfFile::DimensionOf(int id) const {
  char name[NC_MAX_NAME + 1] = {};
  Dimension d;
  Check(netcdf_.inq_dim(id_, id, name, &d.size), "a dimension cannot be read");
  d.name = name;
  return d;
}

std::optional<std::string> NetcdfFile::Text(const Variable& variable, const char* attribute) const {
  nc_type type = NC_NAT;
  std::size_t length = 0;
  if (netcdf_.inq_att(id_, variable.id, attribute, &type, &length) != NC_NOERR) return {};
  if (type == NC_STRING && length == 1) {
    char* text = nullptr;
    Check(netcdf_.get_att_string(id_, variable.id, attribute, &text),
          "an attribute cannot be read");
    std::string value = text == nullptr ? "" : text;
    netcdf_.free_string(1, &text);
    return value;
  }
  if (type != NC_CHAR || length > kLongestText) return {};
  std::string value(length, '\0');
  Check(netcdf_.get_att_text(id_, variable.id, attribute, value.data()),
        "an attribute cannot be read");
  return value.substr(0, value.find('\0'));
}

std::optional<double> NetcdfFile::Number(const Variable& variable, const char* attribute) const {
  nc_type type = NC_NAT;
  std::size_t length = 0;
  if (netcdf_.inq_att(id_, variable.id, attribute, &type, &length) != NC_NOERR) return {};
  if (type == NC_CHAR || type == NC_STRING || length != 1) {
    Refuse("attribute " + std::string(attribute) + " of " + variable.name + " is not a number");
  }
  double value = 0.0;
  Check(netcdf_.get_att_double(id_, variable.id, attribute, &value), "an attribute cannot be read");
  return value;
}

std::vector<double> NetcdfFile::Doubles(const Variable& variable, std::size_t count) const {
  std::vector<double> values(count);
  const std::size_t start = 0;
  Check(netcdf_.get_vara_double(id_, variable.id, &start, &count, values.data()),
        ("damaged: " + variable.name + " cannot be read").c_str());
  return values;
}

std::vector<float> NetcdfFile::Floats(const Variable& variable, const std::size_t (&start)[2],
                                      const std::size_t (&count)[2]) const {
  std::vector<float> values(count[0] * count[1]);
  Check(netcdf_.get_vara_float(id_, variable.id, start, count, values.data()),
        ("damaged: " + variable.name + " cannot be read").c_str());
  return values;
}

}  // namespace stg::dynamics
