// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/mxtp.hpp"

namespace kinemap::mxtp {

const char* to_string(Fault fault) {
  switch (fault) {
    case Fault::TooShort:
      return "too_short";
    case Fault::BadMagic:
      return "bad_magic";
    case Fault::UnknownType:
      return "unknown_type";
    case Fault::BadLength:
      return "bad_length";
    case Fault::BadItemCount:
      return "bad_item_count";
    case Fault::NotFinite:
      return "not_finite";
    case Fault::NotUnit:
      return "not_unit";
    case Fault::OutOfRange:
      return "out_of_range";
    case Fault::BadText:
      return "bad_text";
  }
  return "unknown";
}

}  // namespace kinemap::mxtp
