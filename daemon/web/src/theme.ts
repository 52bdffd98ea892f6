// SPDX-License-Identifier: Apache-2.0
// Light and dark follow the system until the button says otherwise. All colours stand in style.css, as custom properties.

export type Theme = "auto" | "light" | "dark";
const kKey = "kinemap-theme";

export function savedTheme(): Theme {
  try {
    const saved = localStorage.getItem(kKey);
    return saved === "light" || saved === "dark" ? saved : "auto";
  } catch {
    return "auto"; // storage may be forbidden
  }
}

export function applyTheme(theme: Theme): void {
  document.documentElement.dataset.theme = theme;
  try {
    if (theme === "auto") localStorage.removeItem(kKey);
    else localStorage.setItem(kKey, theme);
  } catch {
    // then it holds for this visit
  }
  dispatchEvent(new Event("themechange"));
}

export const isDark = () => getComputedStyle(document.documentElement).getPropertyValue("--dark").trim() === "1";

/** Calls back whenever the colours have changed. */
export function onThemeChange(callback: () => void): () => void {
  const media = matchMedia("(prefers-color-scheme: dark)");
  media.addEventListener("change", callback);
  addEventListener("themechange", callback);
  return () => {
    media.removeEventListener("change", callback);
    removeEventListener("themechange", callback);
  };
}

/** A custom property's colour as the browser understands it: "rgb(…)". */
export function colour(name: string): string {
  const probe = document.createElement("span");
  probe.style.color = `var(--${name})`;
  document.body.append(probe);
  const value = getComputedStyle(probe).color;
  probe.remove();
  return value;
}

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;
