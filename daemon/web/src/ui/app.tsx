// SPDX-License-Identifier: Apache-2.0
import { useEffect, useRef, useState } from "preact/hooks";
import type { Wearer } from "../live";
import { Plan } from "../plan/plan";
import { type Store, useNow, useStore, type View } from "../store";
import { applyTheme, savedTheme, type Theme } from "../theme";
import { EventList } from "./events";
import { Figures } from "./figures";
import { FileList } from "./files";
import { Icon } from "./icons";
import { ObjectDetail, ObjectList } from "./objects";
import { SceneHost } from "./scene_host";
import { useSheet } from "./sheet";
import { SuitPanel } from "./suit";
import { suitState, type SuitState } from "./suit_state";
import { TokenPrompt } from "./token_prompt";

const kTabs = ["Objects", "Events", "Suit", "Files"] as const;
type Tab = (typeof kTabs)[number];
const kThemes: Theme[] = ["auto", "light", "dark"];

function ThemeButton() {
  const [theme, setTheme] = useState(savedTheme());
  const next = kThemes[(kThemes.indexOf(theme) + 1) % kThemes.length] ?? "auto";
  const label = `Colours: ${theme === "auto" ? "as the system" : theme}`;
  return (
    <button
      type="button"
      class="icon-button"
      aria-label={label}
      title={label}
      onClick={() => {
        setTheme(next);
        applyTheme(next);
      }}
    >
      <Icon name={theme} />
    </button>
  );
}

function Tabs({ tab, counts, onTab }: { tab: Tab; counts: Partial<Record<Tab, number>>; onTab: (tab: Tab) => void }) {
  const keys = (event: KeyboardEvent) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    const next = kTabs[(kTabs.indexOf(tab) + step + kTabs.length) % kTabs.length] ?? tab;
    onTab(next);
    document.getElementById(`tab-${next}`)?.focus();
  };
  return (
    <div class="tabs" role="tablist" aria-label="What to list" onKeyDown={keys}>
      {kTabs.map((name) => (
        <button type="button" role="tab" id={`tab-${name}`} aria-selected={tab === name} aria-controls="tabpanel" tabindex={tab === name ? 0 : -1} onClick={() => onTab(name)}>
          {name}
          {counts[name] ? <span>{counts[name]}</span> : null}
        </button>
      ))}
    </div>
  );
}

/** Over the empty stage a word of welcome, over a map a line: what is wrong, since when, and what to do. */
function Notice({ state, empty }: { state: SuitState; empty: boolean }) {
  if (!state.detail) return null;
  return (
    <div class={`notice tone-${state.tone}${empty ? " notice-empty" : ""}`}>
      <strong>{state.title}</strong>
      <p>{state.detail}</p>
    </div>
  );
}

function Legend({ raw }: { raw: boolean }) {
  return (
    <ul class="legend" aria-label="Lines">
      <li class="legend-track">corrected path</li>
      {raw && <li class="legend-raw">as the suit has it</li>}
    </ul>
  );
}

export function App({ store, wearer, onToken }: { store: Store; wearer: Wearer; onToken: (token: string) => void }) {
  const state = useStore(store);
  const now = useNow();
  const [tab, setTab] = useState<Tab>("Objects");
  const [fits, setFits] = useState(0);
  const [zooms, setZooms] = useState(0);
  const sheet = useSheet();
  const opener = useRef<HTMLElement | null>(null);
  const panel = useRef<HTMLElement>(null);
  const { map, track, selected, follow, events } = state;
  const view: View = state.no3d ? "plan" : state.view;
  const object = map.objects.find(({ id }) => id === selected);
  const suit = suitState(state, now);

  const select = (id: number | undefined) => {
    if (store.get().selected === undefined) opener.current = document.activeElement as HTMLElement | null;
    store.set({ selected: id });
    if (id !== undefined) sheet.setStop((old) => (old === "peek" ? "half" : old));
  };
  const close = () => {
    const last = store.get().selected;
    store.set({ selected: undefined });
    // Back to where one came from: the item in the list, which is drawn again.
    requestAnimationFrame(() => {
      const item = panel.current?.querySelector<HTMLElement>(`button.item[data-object="${last}"]`);
      (opener.current?.isConnected ? opener.current : item)?.focus();
    });
  };
  useEffect(() => {
    if (object) panel.current?.querySelector<HTMLElement>(".detail h2")?.focus({ preventScroll: true });
  }, [object?.id]);
  useEffect(() => {
    const keys = (event: KeyboardEvent) => event.key === "Escape" && store.get().selected !== undefined && close();
    addEventListener("keydown", keys);
    return () => removeEventListener("keydown", keys);
  });

  const stage = { map, track, wearer, follow, fits, zooms, selected, onSelect: select };
  const nothing = map.objects.length === 0 && track.length === 0;
  return (
    <div class={`app sheet-${sheet.stop}${state.link.phase === "lost" ? " stale" : ""}`}>
      {state.locked && <TokenPrompt wrong={state.locked === "wrong"} onToken={onToken} />}
      <header class="bar">
        <h1>Kinemap</h1>
        <p class={`pill tone-${suit.tone}`}>
          <strong role="status">{suit.title}</strong>
          <span>{suit.tone === "live" ? state.status?.suit.wearer.name : suit.lasted}</span>
        </p>
        <ThemeButton />
      </header>

      <main class="stage" aria-label="Map">
        {view === "plan" ? (
          <Plan {...stage} />
        ) : (
          <SceneHost {...stage} onFail={(no3d) => store.set({ no3d, view: "plan" })} />
        )}
        <Notice state={suit} empty={nothing} />
        {state.no3d && <p class="no3d" role="status">{state.no3d}</p>}
        {track.length > 1 && <Legend raw={track.some((pose) => pose.odometry !== undefined)} />}
        <div class="views" role="group" aria-label="View">
          <button type="button" aria-pressed={view === "3d"} disabled={state.no3d !== undefined} onClick={() => store.set({ view: "3d" })}>
            3-D
          </button>
          <button type="button" aria-pressed={view === "plan"} onClick={() => store.set({ view: "plan" })}>
            Plan
          </button>
        </div>
        <div class="tools" role="group" aria-label="Camera">
          <button type="button" class="icon-button" aria-pressed={follow} aria-label="Follow the wearer" title="Follow the wearer" onClick={() => store.set({ follow: !follow })}>
            <Icon name="follow" />
          </button>
          <button
            type="button"
            class="icon-button"
            aria-label="Show everything"
            title="Show everything"
            onClick={() => {
              store.set({ follow: false });
              setFits(fits + 1);
            }}
          >
            <Icon name="fit" />
          </button>
          <button type="button" class="icon-button zoom" aria-label="Closer" title="Closer" onClick={() => setZooms(zooms + 1)}>
            <Icon name="plus" />
          </button>
          <button type="button" class="icon-button zoom" aria-label="Farther" title="Farther" onClick={() => setZooms(zooms - 1)}>
            <Icon name="minus" />
          </button>
        </div>
      </main>

      <aside class="panel" ref={panel} aria-label="Details">
        <button type="button" class="handle" aria-label={sheet.stop === "peek" ? "Open the panel" : "Close the panel"} aria-expanded={sheet.stop !== "peek"} {...sheet.handle} />
        <Figures state={state} wearer={wearer} />
        {object ? (
          <div class="scroll">
            <ObjectDetail object={object} map={map} onClose={close} />
          </div>
        ) : (
          <>
            <Tabs
              tab={tab}
              counts={{ Objects: map.objects.length, Events: events.length }}
              onTab={(name) => {
                setTab(name);
                sheet.setStop((old) => (old === "peek" ? "half" : old));
              }}
            />
            <div class="scroll" role="tabpanel" id="tabpanel" aria-labelledby={`tab-${tab}`} tabindex={0}>
              {tab === "Objects" && <ObjectList map={map} selected={selected} onSelect={select} />}
              {tab === "Events" && <EventList events={events} map={map} onSelect={select} />}
              {tab === "Files" && <FileList />}
              {tab === "Suit" && <SuitPanel state={state} wearer={wearer} />}
            </div>
          </>
        )}
      </aside>
    </div>
  );
}
