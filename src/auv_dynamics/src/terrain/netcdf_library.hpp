#pragma once

#include <netcdf.h>

#include <mutex>

namespace stg::dynamics {

/// The functions of libnetcdf, which is loaded when the first terrain is opened. With its own
/// libraries (HDF5, curl, TLS, Kerberos, XML, ...) it needs seven megabytes. Every agent would need
/// them, although only a world reads terrain.
class NetcdfLibrary {
 public:
  /// Throws UserError if the library is not installed.
  static const NetcdfLibrary& Get();
  /// libnetcdf supports only one thread at a time, even for different files. Keep this lock while a
  /// file is open.
  [[nodiscard]] static std::unique_lock<std::mutex> Lock();

  decltype(&::nc_strerror) strerror = nullptr;
  decltype(&::nc_open) open = nullptr;
  decltype(&::nc_close) close = nullptr;
  decltype(&::nc_inq_nvars) inq_nvars = nullptr;
  decltype(&::nc_inq_var) inq_var = nullptr;
  decltype(&::nc_inq_vardimid) inq_vardimid = nullptr;
  decltype(&::nc_inq_dim) inq_dim = nullptr;
  decltype(&::nc_inq_att) inq_att = nullptr;
  decltype(&::nc_get_att_string) get_att_string = nullptr;
  decltype(&::nc_free_string) free_string = nullptr;
  decltype(&::nc_get_att_text) get_att_text = nullptr;
  decltype(&::nc_get_att_double) get_att_double = nullptr;
  decltype(&::nc_get_vara_double) get_vara_double = nullptr;
  decltype(&::nc_get_vara_float) get_vara_float = nullptr;
  decltype(&::nc_create) create = nullptr;
  decltype(&::nc_def_dim) def_dim = nullptr;
  decltype(&::nc_def_var) def_var = nullptr;
  decltype(&::nc_put_att_text) put_att_text = nullptr;
  decltype(&::nc_enddef) enddef = nullptr;
  decltype(&::nc_put_var_double) put_var_double = nullptr;
  decltype(&::nc_put_var_short) put_var_short = nullptr;

 private:
  NetcdfLibrary();
};

}  // namespace stg::dynamics
