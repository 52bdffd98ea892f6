// SPDX-License-Identifier: Apache-2.0
// Line icons on a grid of 20.
const kPaths = {
  fit: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4",
  follow: "M10 2v3M10 15v3M2 10h3M15 10h3M10 5.5a4.5 4.5 0 1 0 0 9a4.5 4.5 0 1 0 0-9M10 9.2a.8.8 0 1 0 0 1.6a.8.8 0 1 0 0-1.6",
  plus: "M10 4v12M4 10h12",
  minus: "M4 10h12",
  close: "M5 5l10 10M15 5L5 15",
  back: "M12 4l-6 6l6 6",
  auto: "M10 3a7 7 0 1 0 0 14zM10 3a7 7 0 0 1 0 14",
  light: "M10 6.5a3.5 3.5 0 1 0 0 7a3.5 3.5 0 1 0 0-7M10 1.5v2M10 16.5v2M1.5 10h2M16.5 10h2M4 4l1.4 1.4M14.6 14.6L16 16M16 4l-1.4 1.4M5.4 14.6L4 16",
  dark: "M16.5 11.8A7 7 0 1 1 8.2 3.5a5.6 5.6 0 0 0 8.3 8.3z",
  chevron: "M5 12.5l5-5l5 5",
  wall: "M3 4h14v12H3zM3 8h14M3 12h14M8 4v4M13 8v4M7 12v4",
  table: "M2.5 6.5h15M4 6.5V16M16 6.5V16",
  screen: "M3 4h14v9.5H3zM7 16.5h6M10 13.5v3",
  chair: "M6 3v8h8M6 11v6M14 11v6",
  other: "M10 3l6 3.5v7L10 17l-6-3.5v-7z",
} as const;

export type IconName = keyof typeof kPaths;

export const Icon = ({ name }: { name: IconName }) => (
  <svg class="icon" viewBox="0 0 20 20" aria-hidden="true">
    <path d={kPaths[name]} />
  </svg>
);

export const typeIcon = (type: string): IconName => (type in kPaths ? (type as IconName) : "other");
