// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace kinemap {

/// protocol/map.schema.json and protocol/api.schema.json, as they are in the repository.
const char* map_schema_text();
const char* api_schema_text();

}  // namespace kinemap
