// SPDX-License-Identifier: Apache-2.0
// Runs a test file, or says loudly that it cannot: exit code 77.
import { spawnSync } from "node:child_process";
import { existsSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
if (!existsSync(join(here, "node_modules/@foxglove/ws-protocol"))) {
  console.log("SKIPPED: the npm packages of tests/foxglove are not here; tools/setup.sh --tests gets them");
  process.exit(77);
}
const { status } = spawnSync(process.execPath, ["--test", join(here, process.argv[2])], { stdio: "inherit" });
process.exit(status ?? 1);
