#pragma once

#include <string>

namespace stg::nodes {

/// Throws rosbag::BagFormatException where the bag at `path` (format 2.0) is damaged in a way that
/// rosbag does not see: a record that ends behind the file, or an index entry that points at no
/// message. rosbag follows both and reads memory that is not the bag's. Reads the whole file once
/// and unpacks its chunks; what the messages hold is not looked at. The message names the byte, not
/// the file.
void RequireSoundBag(const std::string& path);

}  // namespace stg::nodes
