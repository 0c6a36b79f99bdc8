import { Mesh, MeshBasicMaterial } from "three";
import type { PoseFrame } from "../connection/frames";
import { between } from "../connection/player";
import type { PoseTrack, Tape } from "../connection/tape";
import { unpack } from "../connection/tape";
import type { SceneDescription, ServerMessage } from "../generated/protocol";
import { isDate } from "../panels/clock";
import type { Toasts } from "../panels/toasts";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import { lookOf } from "../world/batches";
import { World } from "../world/world";
import type { Stage } from "./stage";

/** A larger file is no exported run that a page can show beside another one, bytes. */
const LARGEST = 256 * 2 ** 20;
const PAGE = /<script id="tape"[^>]*>([^<]*)<\/script>/;
/** Seconds of a tick, for runs whose time is a date. */
const TICK = 1 / 60;

/** An earlier run beside the present one: what moved in it is drawn translucent, at the same time since the beginning. */
export class Ghost {
  readonly element = h("p", { class: "notice beside", hidden: true });
  readonly button: HTMLElement;
  private readonly skin = new MeshBasicMaterial({ color: 0x2f7bff, transparent: true, opacity: 0.35, depthWrite: false, toneMapped: false });
  private readonly worlds = new Map<number, World | null>();
  private tape: Tape | null = null;
  private shown: World | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly toasts: Toasts,
    private readonly poses: Signal<PoseFrame | null>,
  ) {
    const input = h("input", { type: "file", accept: ".html,.htm", hidden: true, "aria-label": "an exported run" });
    input.addEventListener("change", () => {
      const file = input.files?.[0];
      input.value = "";
      if (file) void this.load(file);
    });
    const title = "Show a run that morse export --html has written, translucent, at the same time";
    this.button = h("div", {}, input, h("button", { type: "button", title, onclick: () => input.click() }, "an earlier run…"));
    poses.watch(() => this.update());
    stage.onDraw(() => this.shown?.sort(lookOf(stage.view.camera, stage.element.clientHeight)));
  }

  /** Show a run; the file is read as text, and nothing of it is executed. */
  async load(file: File): Promise<void> {
    this.close();
    try {
      const text = file.size <= LARGEST ? (await file.text()).match(PAGE)?.[1] : undefined;
      if (text === undefined) throw new Error("it is no page of morse export --html");
      this.tape = await unpack(text);
      for (const track of this.tape.poses) this.worlds.set(track.revision, await this.worldOf(this.tape, track));
    } catch (error) {
      this.close();
      this.toasts.show(`${file.name} cannot be shown beside this run: ${error instanceof Error ? error.message : String(error)}`, "error");
      return;
    }
    this.element.replaceChildren(`beside: ${file.name}`, iconButton(icons.close, "Close the earlier run", () => this.close()));
    this.element.hidden = false;
    this.update();
  }

  close(): void {
    this.show(null);
    for (const world of this.worlds.values()) world?.dispose();
    this.worlds.clear();
    this.tape = null;
    this.element.hidden = true;
  }

  /** What moves of a world, without textures and lamps. */
  private async worldOf(tape: Tape, { revision }: PoseTrack): Promise<World | null> {
    const messages: ServerMessage[] = [...tape.tracks.values()].flatMap((track) => track.messages);
    const url = messages.find((message) => message.type === "world" && message.revision === revision);
    const file = url?.type === "world" ? tape.files.get(url.url) : undefined;
    if (!file) return null;
    const described = JSON.parse(await file.text()) as SceneDescription;
    const moves: boolean[] = [];
    const nodes = described.nodes.map((node) => {
      const moving = node.frame !== "" || (moves[node.parent] ?? false);
      moves.push(moving);
      return { ...node, mesh: moving ? node.mesh : -1, light: null, camera: null };
    });
    const materials = described.materials.map((material) => ({ ...material, image: "" }));
    const world = await World.load({ ...described, nodes, materials }, { ...this.stage.surfaces, anisotropy: 1 }, this.stage.invalidate, async (path) => new Response(tape.files.get(path) ?? null, { status: tape.files.has(path) ? 200 : 404 }));
    world.root.traverse((object) => {
      if (!(object instanceof Mesh)) return;
      object.material = this.skin;
      object.castShadow = object.receiveShadow = false;
    });
    return world;
  }

  private show(world: World | null): void {
    if (world === this.shown) return;
    this.shown?.root.removeFromParent();
    if (world) this.stage.scene.add(world.root);
    this.shown = world;
    this.stage.invalidate();
  }

  private update(): void {
    const frame = this.poses.value;
    if (!this.tape || !frame) return;
    const since = isDate(frame.time) ? frame.tick * TICK : frame.time;
    const time = isDate(this.tape.begin) ? this.tape.begin + since : since;
    const track = this.tape.poses.filter(({ times }) => (times[0] ?? Infinity) <= time + 1e-6).at(-1) ?? this.tape.poses[0];
    const world = track && this.worlds.get(track.revision);
    if (track && world) world.apply({ ...frame, revision: track.revision, poses: between(track, time) });
    this.show(world ?? null);
    this.stage.invalidate();
  }
}
