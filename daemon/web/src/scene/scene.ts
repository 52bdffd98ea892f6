// SPDX-License-Identifier: Apache-2.0
// The 3-D view. It draws a frame only when something has changed: a wearable's viewer is often a phone.
import {
  DirectionalLight,
  Group,
  HemisphereLight,
  type LineSegments,
  type Object3D,
  Raycaster,
  Scene as ThreeScene,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import { CSS2DObject, CSS2DRenderer } from "three/addons/renderers/CSS2DRenderer.js";
import { boundsOf } from "../bounds";
import { objectName } from "../format";
import { floorAt, floorOf, quietSpot } from "../geometry";
import type { Wearer } from "../live";
import type { MapDocument, MapObject, TrackPose } from "../model";
import { onThemeChange, reducedMotion } from "../theme";
import { CameraRig } from "./camera_rig";
import { Figure } from "./figure";
import { gridLines } from "./grid";
import { disposeGroup, objectGroup } from "./objects";
import { Palette } from "./palette";
import { roomsGroup } from "./rooms";
import { Tracks } from "./tracks";

export interface SceneInput {
  map: MapDocument;
  track: TrackPose[];
  selected?: number;
  follow: boolean;
}

const kRoomLabelPx = 110; // smaller rooms have no space for their name

export class SceneView {
  private renderer: WebGLRenderer;
  private labels = new CSS2DRenderer();
  private scene = new ThreeScene();
  private rig: CameraRig;
  private palette = new Palette();
  private figure = new Figure(this.palette);
  private tracks = new Tracks(this.palette);
  private grid?: LineSegments;
  private rooms = new Group();
  private objects = new Map<number, { object: MapObject; selected: boolean; group: Group }>();
  private labelled = new Group();
  private input: SceneInput = { map: { revision: 0, time: 0, objects: [], rooms: [] }, track: [], follow: false };
  private hovered?: number;
  private requested = false;
  private drawn = 0; // ms of the animation clock
  private stop: (() => void)[] = [];

  /** Throws when there is no WebGL. */
  constructor(
    private host: HTMLElement,
    private wearer: Wearer,
    private onSelect: (id: number | undefined) => void,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.domElement.className = "scene-canvas";
    this.labels.domElement.className = "scene-labels";
    host.append(this.renderer.domElement, this.labels.domElement);
    this.rig = new CameraRig(this.renderer.domElement, () => this.draw());
    const sun = new DirectionalLight(0xffffff, 1.5);
    sun.position.set(-3, -5, 8);
    this.scene.add(new HemisphereLight(0xffffff, 0xb4bcc2, 2.5), sun);
    this.scene.add(this.rooms, this.tracks.group, this.figure.group, this.labelled);
    this.recolour();
    this.listen();
    this.resize();
  }

  update(input: SceneInput): void {
    const before = this.input;
    this.input = input;
    if (input.map !== before.map || input.selected !== before.selected) this.showMap(input.map !== before.map);
    if (input.track !== before.track) this.tracks.show(input.track);
    if (input.map !== before.map || input.track !== before.track) this.showGrid();
    if (input.follow && !before.follow) this.rig.auto = false;
    if (this.rig.auto && (input.map !== before.map || input.track !== before.track)) this.frameAll();
    this.draw();
  }

  /** Everything in view, and from now on as the map grows. */
  fit(): void {
    this.rig.auto = true;
    this.frameAll();
    this.draw();
  }

  zoom(factor: number): void {
    this.rig.zoom(factor);
    this.draw();
  }

  dispose(): void {
    for (const stop of this.stop) stop();
    this.rig.controls.dispose();
    this.renderer.dispose();
    this.host.replaceChildren();
  }

  private listen(): void {
    const observer = new ResizeObserver(() => this.resize());
    observer.observe(this.host);
    this.stop.push(
      () => observer.disconnect(),
      this.wearer.onSample(() => this.draw()),
      onThemeChange(() => {
        this.palette = new Palette();
        this.recolour();
        this.showMap(true, true);
        this.draw();
      }),
    );
    const canvas = this.renderer.domElement;
    let down: { x: number; y: number } | undefined;
    canvas.addEventListener("pointerdown", (event) => (down = { x: event.clientX, y: event.clientY }));
    canvas.addEventListener("pointerup", (event) => {
      // A click, not the end of a turn.
      if (down && Math.hypot(event.clientX - down.x, event.clientY - down.y) < 6) this.onSelect(this.pick(event));
      down = undefined;
    });
    canvas.addEventListener("pointermove", (event) => event.pointerType === "mouse" && !event.buttons && this.hover(this.pick(event)));
    canvas.addEventListener("pointerleave", () => this.hover(undefined));
  }

  private hover(id: number | undefined): void {
    if (id === this.hovered) return;
    this.hovered = id;
    this.renderer.domElement.style.cursor = id === undefined ? "" : "pointer";
    this.showLabels();
    this.draw();
  }

  private pick(event: PointerEvent): number | undefined {
    const box = this.renderer.domElement.getBoundingClientRect();
    const point = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(point, this.rig.camera);
    let walls: number | undefined;
    for (const hit of ray.intersectObjects([...this.objects.values()].map(({ group }) => group))) {
      let node: Object3D | null = hit.object;
      while (node && node.userData.object === undefined) node = node.parent;
      const id = node?.userData.object as number | undefined;
      if (id === undefined) continue;
      // What stands before or behind a translucent wall is meant rather than the wall.
      if (this.objects.get(id)?.object.type !== "wall") return id;
      walls ??= id;
    }
    return walls;
  }

  private recolour(): void {
    this.showGrid();
    this.figure.recolour(this.palette);
    this.tracks.recolour(this.palette);
  }

  private showGrid(): void {
    this.grid?.geometry.dispose();
    this.grid?.removeFromParent();
    this.grid = gridLines(boundsOf(this.input.map, this.input.track), this.palette);
    this.scene.add(this.grid);
  }

  private showMap(changed: boolean, all = false): void {
    const { map, selected } = this.input;
    if (changed) {
      disposeGroup(this.rooms);
      this.rooms.removeFromParent();
      this.rooms = roomsGroup(map, this.palette);
      this.scene.add(this.rooms);
    }
    const gone = new Set(this.objects.keys());
    for (const object of map.objects) {
      gone.delete(object.id);
      const shown = this.objects.get(object.id);
      const isSelected = object.id === selected;
      if (!all && shown?.object === object && shown.selected === isSelected) continue;
      if (shown) this.remove(object.id);
      const group = objectGroup(object, this.palette, isSelected, floorAt([object.pose.position[0], object.pose.position[1]], map));
      this.objects.set(object.id, { object, selected: isSelected, group });
      this.scene.add(group);
    }
    for (const id of gone) this.remove(id);
    this.showLabels();
  }

  private remove(id: number): void {
    const shown = this.objects.get(id);
    if (!shown) return;
    disposeGroup(shown.group);
    shown.group.removeFromParent();
    this.objects.delete(id);
  }

  private showLabels(): void {
    this.labelled.clear();
    const { map, selected } = this.input;
    for (const room of map.rooms) {
      const [x, y] = quietSpot(room, map);
      const label = this.label(`Room ${room.id}`, `${room.area.toFixed(1)} m²`, new Vector3(x, y, floorOf(room, map)), "room");
      label.userData.extent = Math.sqrt(room.area);
    }
    for (const id of new Set([selected, this.hovered])) {
      const object = id === undefined ? undefined : this.objects.get(id)?.object;
      if (!object) continue;
      const [x, y, z] = object.pose.position;
      const top = object.corners ? Math.max(...object.corners.map((corner) => corner[2])) : z + 0.4;
      this.label(objectName(object), "", new Vector3(x, y, object.type === "wall" ? z : top + 0.12), id === selected ? "selected" : "hover");
    }
  }

  private label(name: string, detail: string, at: Vector3, kind: string): CSS2DObject {
    const element = document.createElement("div");
    element.className = `label label-${kind}`;
    element.append(name);
    if (detail) {
      const small = document.createElement("small");
      small.textContent = detail;
      element.append(small);
    }
    const label = new CSS2DObject(element);
    label.position.copy(at);
    if (kind !== "room") label.center.set(0.5, 1.15); // above what it names
    this.labelled.add(label);
    return label;
  }

  private frameAll(): void {
    const { map, track } = this.input;
    const tall = map.objects.some((object) => object.type === "wall") ? 2.0 : 1.4;
    this.rig.frame(boundsOf(map, track, this.wearer.shown(performance.now())?.position), tall);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.host;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(clientWidth, clientHeight);
    this.labels.setSize(clientWidth, clientHeight);
    this.tracks.resize(clientWidth, clientHeight);
    this.rig.resize(clientWidth, clientHeight);
    if (this.rig.auto) this.frameAll();
    this.draw();
  }

  private draw(): void {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame((now) => {
      this.requested = false;
      this.frame(now);
    });
  }

  private frame(now: number): void {
    const sample = this.wearer.shown(now);
    this.figure.show(sample);
    if (sample && this.rig.lost(sample.position)) this.frameAll();
    if (this.input.follow && sample) this.rig.follow(sample.position);
    const easing = this.rig.move(this.drawn === 0 || reducedMotion() ? "all" : Math.min(now - this.drawn, 100));
    this.drawn = now;
    for (const label of this.labelled.children) {
      const extent = label.userData.extent as number | undefined;
      if (extent !== undefined) label.visible = this.rig.pixels(extent, label.position, this.host.clientHeight) > kRoomLabelPx;
    }
    this.renderer.render(this.scene, this.rig.camera);
    this.labels.render(this.scene, this.rig.camera);
    if (easing || this.wearer.moving(now)) this.draw();
  }
}
