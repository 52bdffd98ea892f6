// SPDX-License-Identifier: Apache-2.0
import { useMemo, useState } from "preact/hooks";
import { clock, degrees, functionText, heading, metres, minus, objectName, plusMinus, shortSize, typePlural, wallLength } from "../format";
import { roomAt } from "../geometry";
import type { MapDocument, MapObject } from "../model";
import { Icon, typeIcon } from "./icons";

const kFilters = [
  { name: "All", function: undefined },
  { name: "Sit", function: "sit" },
  { name: "Put down", function: "place" },
  { name: "Look at", function: "view" },
  { name: "Walls", function: "bound" },
] as const;
const kOrder = ["table", "screen", "chair", "wall"];

const rank = (type: string) => (kOrder.indexOf(type) + kOrder.length + 1) % (kOrder.length + 1);

function byType(objects: MapObject[]): [string, MapObject[]][] {
  const groups = new Map<string, MapObject[]>();
  for (const object of objects) groups.set(object.type, [...(groups.get(object.type) ?? []), object]);
  return [...groups].sort(([a], [b]) => rank(a) - rank(b));
}

/** Arrow keys go through the list; Enter and Space are the buttons' own. */
function moveFocus(event: KeyboardEvent): void {
  const step = { ArrowDown: 1, ArrowUp: -1 }[event.key];
  if (!step || !(event.currentTarget instanceof HTMLElement)) return;
  const items = [...event.currentTarget.querySelectorAll<HTMLElement>("button.item")];
  const next = items[items.indexOf(document.activeElement as HTMLElement) + step];
  if (!next) return;
  event.preventDefault();
  next.focus();
}

interface ListProps {
  map: MapDocument;
  selected: number | undefined;
  onSelect: (id: number) => void;
}

export function ObjectList({ map, selected, onSelect }: ListProps) {
  const [filter, setFilter] = useState<string | undefined>(undefined);
  const shown = useMemo(() => map.objects.filter((object) => !filter || object.functions.includes(filter)), [map, filter]);
  if (map.objects.length === 0)
    return (
      <p class="empty">
        Nothing found yet. Sitting down marks a seat; with the left hand on the hip, the right hand draws walls, tables and screens.
      </p>
    );
  return (
    <>
      <div class="filters" role="group" aria-label="Show what one can use for">
        {kFilters.map(({ name, function: wanted }) => (
          <button type="button" aria-pressed={filter === wanted} onClick={() => setFilter(wanted)}>
            {name}
          </button>
        ))}
      </div>
      <div class="list" onKeyDown={moveFocus}>
        {byType(shown).map(([type, objects]) => (
          <section key={type} aria-label={typePlural(type)}>
            <h2 class="group">
              {typePlural(type)} <span>{objects.length}</span>
            </h2>
            <ul>
              {objects.map((object) => (
                <li key={object.id}>
                  <button type="button" class={`item type-${type}`} aria-current={object.id === selected} onClick={() => onSelect(object.id)} data-object={object.id}>
                    <Icon name={typeIcon(type)} />
                    <span class="item-name">{objectName(object)}</span>
                    <span class="item-size">{shortSize(object)}</span>
                  </button>
                </li>
              ))}
            </ul>
          </section>
        ))}
        {shown.length === 0 && <p class="empty">Nothing of that kind yet.</p>}
      </div>
    </>
  );
}

function sizeRows(object: MapObject): [string, string][] {
  const { size, sigma, type } = object;
  const [, , z] = object.pose.position;
  const height: [string, string] = [type === "chair" ? "Seat height" : "Height", `${metres(z)}`];
  if (!size) return [height];
  const [a, b] = size;
  const [sa, sb] = sigma?.size ?? [];
  if (type === "wall")
    return [
      ["Length", wallLength(object, true)],
      ["Height", object.height_assumed ? `${b.toFixed(2)} m, assumed` : `${plusMinus(b, sb)} m`],
    ];
  const rows: [string, string][] = [
    ["Length", `${plusMinus(a, sa)} m`],
    ["Width", `${plusMinus(b, sb)} m`],
  ];
  return [...rows, [type === "screen" ? "Centre height" : "Height", height[1]]];
}

export function ObjectDetail({ object, map, onClose }: { object: MapObject; map: MapDocument; onClose: () => void }) {
  const [x, y] = object.pose.position;
  const room = map.rooms.find(({ walls }) => walls.includes(object.id)) ?? roomAt([x, y], map);
  const rows: [string, string][] = [
    ...sizeRows(object),
    ["Position", `${minus(x.toFixed(2))}, ${minus(y.toFixed(2))} m`],
    ...(object.sigma?.position === undefined ? [] : [["Uncertainty", `± ${metres(Math.max(object.sigma.position, 0.01))}`] as [string, string]]),
    [object.type === "chair" ? "Faces" : "Heading", degrees(heading(object.pose)) + (object.sigma?.heading === undefined ? "" : ` ± ${degrees(object.sigma.heading, 1)}`)],
  ];
  if (room) rows.push(["Room", String(room.id)]);
  const visits = object.visits ?? [];
  return (
    <article class={`detail type-${object.type}`} aria-label={objectName(object)}>
      <header>
        <Icon name={typeIcon(object.type)} />
        <h2 tabindex={-1}>{objectName(object)}</h2>
        <button type="button" class="icon-button" aria-label="Close (Esc)" title="Close (Esc)" onClick={onClose}>
          <Icon name="close" />
        </button>
      </header>
      {object.functions.map((name) => (
        <p class="function">{functionText(name)}</p>
      ))}
      <dl class="rows">
        {rows.map(([name, value]) => (
          <div>
            <dt>{name}</dt>
            <dd>{value}</dd>
          </div>
        ))}
      </dl>
      <h3>
        Visits <span>{object.observations}</span>
      </h3>
      {visits.length > 0 && (
        <ol class="visits">
          {visits.map(([begin, end]) => (
            <li>
              {clock(begin)} – {clock(end)}
            </li>
          ))}
        </ol>
      )}
      <p class="note">± is one standard deviation.</p>
    </article>
  );
}
