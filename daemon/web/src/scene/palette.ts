// SPDX-License-Identifier: Apache-2.0
import { Color } from "three";
import { colour } from "../theme";

const kTypes = ["wall", "table", "screen", "chair"] as const;
const kOthers = ["stage", "grid", "floor", "ink", "accent", "raw", "track", "wearer", "other"] as const;

/** The colours of style.css for the 3-D view; made anew when the theme changes. */
export class Palette {
  private colours = new Map<string, Color>();

  constructor() {
    for (const name of [...kTypes, ...kOthers]) this.colours.set(name, new Color(colour(name)));
  }
  get(name: (typeof kOthers)[number]): Color {
    return this.type(name);
  }
  /** Of an object's type; types that are not known look alike. */
  type(name: string): Color {
    return this.colours.get(name) ?? this.colours.get("other") ?? new Color();
  }
}
