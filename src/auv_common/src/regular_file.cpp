#include "auv_common/regular_file.hpp"

#include <filesystem>
#include <string_view>
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

std::ifstream OpenText(const std::string& path, std::uintmax_t largest) {
  RequireRegularFile(path, largest);
  std::ifstream in(path);
  if (!in) throw UserError(path + ": cannot be read");
  char mark[3] = {};
  if (!in.read(mark, 3) || std::string_view(mark, 3) != "\xEF\xBB\xBF") {
    in.clear();
    in.seekg(0);
  }
  return in;
}

}  // namespace stg
