// SPDX-License-Identifier: Apache-2.0
#include "protocol/map_json.hpp"
