#pragma once

#include <string>

namespace stg::nodes {

/// Throws rosbag::BagFormatException if the bag at `path` (format 2.0) has a damage that rosbag
/// does not notice: a record that ends behind the file, or an index entry that does not point at a
/// message. rosbag follows both and reads memory outside the bag. This function reads the whole
/// file once and unpacks its chunks, but does not check the content of messages. The error names
/// the byte, not the file.
void RequireSoundBag(const std::string& path);

}  // namespace stg::nodes
