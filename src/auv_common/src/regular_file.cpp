#include "auv_common/regular_file.hpp"

#include <filesystem>
#include <system_error>

#include "auv_common/error.hpp"

namespace stg {

void RequireRegularFile(const std::string& path, std::uintmax_t largest) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (status.type() == fs::file_type::not_found) throw UserError(path + ": no such file");
  if (error) throw UserError(path + ": " + error.message());
  if (fs::is_directory(status)) throw UserError(path + ": is a directory, not a file");
  if (!fs::is_regular_file(status)) throw UserError(path + ": not a regular file");
  if (fs::file_size(path, error) > largest && !error) {
    throw UserError(path + ": larger than " + std::to_string(largest) +
                    " bytes, refused before reading");
  }
}

}  // namespace stg
