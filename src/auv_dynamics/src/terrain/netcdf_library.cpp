#include "netcdf_library.hpp"

#include <dlfcn.h>

#include <string>

#include "auv_common/error.hpp"

namespace stg::dynamics {
namespace {

template <class Function>
void Find(void* library, const char* name, Function* function) {
  *function = reinterpret_cast<Function>(dlsym(library, name));
  if (*function == nullptr) throw UserError(std::string(STG_NETCDF ": has no function ") + name);
}

}  // namespace

const NetcdfLibrary& NetcdfLibrary::Get() {
  static const NetcdfLibrary library;
  return library;
}

std::unique_lock<std::mutex> NetcdfLibrary::Lock() {
  static std::mutex mutex;
  return std::unique_lock(mutex);
}

NetcdfLibrary::NetcdfLibrary() {
  void* library = dlopen(STG_NETCDF, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* why = dlerror();
    throw UserError(std::string("terrain cannot be read: ") + (why == nullptr ? STG_NETCDF : why));
  }
  Find(library, "nc_strerror", &strerror);
  Find(library, "nc_open", &open);
  Find(library, "nc_close", &close);
  Find(library, "nc_inq_nvars", &inq_nvars);
  Find(library, "nc_inq_var", &inq_var);
  Find(library, "nc_inq_vardimid", &inq_vardimid);
  Find(library, "nc_inq_dim", &inq_dim);
  Find(library, "nc_inq_att", &inq_att);
  Find(library, "nc_get_att_string", &get_att_string);
  Find(library, "nc_free_string", &free_string);
  Find(library, "nc_get_att_text", &get_att_text);
  Find(library, "nc_get_att_double", &get_att_double);
  Find(library, "nc_get_vara_double", &get_vara_double);
  Find(library, "nc_get_vara_float", &get_vara_float);
  Find(library, "nc_create", &create);
  Find(library, "nc_def_dim", &def_dim);
  Find(library, "nc_def_var", &def_var);
  Find(library, "nc_put_att_text", &put_att_text);
  Find(library, "nc_enddef", &enddef);
  Find(library, "nc_put_var_double", &put_var_double);
  Find(library, "nc_put_var_short", &put_var_short);
}

}  // namespace stg::dynamics
