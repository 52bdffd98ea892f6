// SPDX-License-Identifier: Apache-2.0
import { download, hasToken } from "../access";

/** The exports that one takes along: name and what reads it; protocol/README.md describes them. */
const kFiles = [
  ["scene.glb", "the map in 3-D, glTF"],
  ["plan.svg", "floor plan with dimensions"],
  ["floor.pgm", "walked floor, for ROS"],
  ["floor.yaml", "where that picture lies"],
  ["world.sdf", "world for Gazebo"],
  ["objects.csv", "table of the objects"],
  ["map.json", "all that is known"],
  ["trajectory.tum", "corrected path"],
  ["odometry.tum", "path as the suit has it"],
  ["graph.g2o", "pose graph"],
  ["session.mcap", "recording for Foxglove"],
] as const;

export function FileList() {
  return (
    <>
      <ul class="files">
        {kFiles.map(([name, what]) => (
          <li>
            <a
              href={`api/v1/export/${name}`}
              download={name}
              onClick={(event) => {
                if (!hasToken()) return;
                event.preventDefault();
                void download(`api/v1/export/${name}`, name);
              }}
            >
              {name}
              <span>{what}</span>
            </a>
          </li>
        ))}
      </ul>
      <p class="note">
        Programs ask the <a href="api/v1/openapi.json">API</a> (OpenAPI 3.1). <a href="licenses.txt">Licences</a> of what this page is made with.
      </p>
    </>
  );
}
