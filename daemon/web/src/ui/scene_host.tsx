// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import type { Wearer } from "../live";
import type { SceneInput, SceneView } from "../scene/scene";

interface Props extends SceneInput {
  wearer: Wearer;
  fits: number;
  zooms: number;
  onSelect: (id: number | undefined) => void;
  /** There is no 3-D on this device, and why. */
  onFail: (reason: string) => void;
}

/** Loads three.js when the 3-D view is first wanted. */
export function SceneHost({ map, track, selected, follow, wearer, fits, zooms, onSelect, onFail }: Props) {
  const host = useRef<HTMLDivElement>(null);
  const [view, setView] = useState<SceneView>();
  const zoomed = useRef(zooms);

  useEffect(() => {
    let gone = false;
    let made: SceneView | undefined;
    import("../scene/scene")
      .then(({ SceneView: View }) => {
        if (gone || !host.current) return;
        made = new View(host.current, wearer, onSelect);
        setView(made);
      })
      .catch(() => onFail("The 3-D view needs WebGL, which this browser does not offer. The plan shows the same map."));
    return () => {
      gone = true;
      made?.dispose();
    };
  }, []);
  useEffect(() => view?.update({ map, track, follow, ...(selected === undefined ? {} : { selected }) }), [view, map, track, selected, follow]);
  useEffect(() => {
    if (fits > 0) view?.fit();
  }, [fits]);
  useEffect(() => {
    if (zooms !== zoomed.current) view?.zoom(zooms > zoomed.current ? 1.4 : 1 / 1.4);
    zoomed.current = zooms;
  }, [zooms]);
  return <div class="scene" ref={host} role="img" aria-label="The map in three dimensions; the list of objects tells the same in words" />;
}
