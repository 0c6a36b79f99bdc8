import { Vector3 } from "three";
import type { Connection } from "../connection/connection";
import type { PoseFrame } from "../connection/frames";
import { fetchFile } from "../connection/tape";
import type { SoundState } from "../generated/protocol";
import { iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import type { Stage } from "../view/stage";
import { Voice, listen } from "./voice";

const KEY = "morse.sound";
/** Duration of volume changes, s. */
const FADE = 0.03;

/** The loudspeakers of robots, heard at the position of the camera. */
export class Sounds {
  readonly button = iconButton(icons.mute, "Sound", () => this.toggle());
  readonly voices = new Map<string, Voice>();
  context: AudioContext | null = null;
  private output: GainNode | null = null;
  private readonly states = new Map<string, SoundState>();
  private readonly files = new Map<string, Promise<AudioBuffer | null>>();
  private muted = localStorage.getItem(KEY) === "off";
  private volume = 0;
  private readonly spot = new Vector3();
  /** the present sound of each voice */
  private readonly played = new WeakMap<Voice, SoundState>();

  constructor(
    connection: Connection,
    private readonly stage: Stage,
    private readonly poses: Signal<PoseFrame | null>,
  ) {
    this.button.hidden = true;
    connection.on("welcome", () => {
      // states of existing loudspeakers are sent again
      this.states.clear();
      this.update();
    });
    connection.on("sound_state", (state) => {
      this.states.set(state.component, state);
      this.update();
    });
    connection.state.watch(() => this.setVolume());
    poses.watch(() => this.setVolume());
    stage.onDraw(() => this.place());
    // browsers allow sound only after a user action on the page
    for (const kind of ["pointerup", "keydown"]) addEventListener(kind, () => this.begin());
    this.show();
  }

  get audible(): boolean {
    return this.context?.state === "running" && !this.muted;
  }

  private toggle(): void {
    this.muted = this.audible;
    localStorage.setItem(KEY, this.muted ? "off" : "on");
    this.begin();
    this.show();
    this.setVolume();
  }

  /** Initialise sound, once there is a loudspeaker. */
  private begin(): void {
    if (this.states.size === 0 || this.muted) return;
    if (!this.context) {
      this.context = new AudioContext();
      this.output = new GainNode(this.context, { gain: 0 });
      this.output.connect(this.context.destination);
      this.context.onstatechange = () => this.show();
      this.update();
    }
    if (this.context.state === "suspended") void this.context.resume();
  }

  private show(): void {
    const { audible, button } = this;
    button.hidden = this.states.size === 0;
    button.innerHTML = audible ? icons.sound : icons.mute;
    button.ariaLabel = button.title = audible ? "Mute" : "Let robots be heard";
  }

  /** Update all loudspeakers. */
  private update(): void {
    this.show();
    const { context, output } = this;
    if (!context || !output) return;
    for (const [name, voice] of this.voices) {
      if (this.states.has(name)) continue;
      voice.dispose();
      this.voices.delete(name);
    }
    [...this.states.values()].forEach((state, index) => {
      let voice = this.voices.get(state.component);
      if (!voice) this.voices.set(state.component, (voice = new Voice(context, output)));
      void this.play(voice, state, index);
    });
    this.place();
    this.setVolume();
  }

  private async play(voice: Voice, state: SoundState, index: number): Promise<void> {
    if (state.mode !== "play") {
      voice.stop();
      return;
    }
    const buffer = state.url === null ? null : await this.fetch(state.url);
    if (this.states.get(state.component) !== state) return; // changed in the meantime
    if (voice.playing && this.played.get(voice) === state) return;
    this.played.set(voice, state);
    const offset = state.played + Math.max(0, (this.poses.value?.time ?? state.time) - state.time);
    if (buffer) voice.playBuffer(buffer, offset);
    else voice.playTone(index);
  }

  /** The sound of a file; null if the browser cannot decode it. */
  private fetch(url: string): Promise<AudioBuffer | null> {
    const { context } = this;
    const read = async (): Promise<AudioBuffer | null> => {
      try {
        const answer = await fetchFile(url);
        return answer.ok && context ? await context.decodeAudioData(await answer.arrayBuffer()) : null;
      } catch {
        return null;
      }
    };
    let file = this.files.get(url);
    if (!file) this.files.set(url, (file = read()));
    return file;
  }

  /** Muted, paused and disconnected simulations are silent. */
  private setVolume(): void {
    const { context, output } = this;
    if (!context || !output) return;
    const wanted = this.muted || this.poses.value?.running !== true ? 0 : 1;
    if (wanted === this.volume) return;
    this.volume = wanted;
    output.gain.setTargetAtTime(wanted, context.currentTime, FADE / 3);
  }

  /** Update the positions of the listener and the loudspeakers. */
  private place(): void {
    const { context } = this;
    const { view, world } = this.stage;
    if (!context || this.voices.size === 0) return;
    listen(context.listener, view.position, view.ahead, view.above);
    for (const [name, voice] of this.voices) {
      const node = world?.find(name);
      if (node) voice.place(this.spot.setFromMatrixPosition(node.frame.matrixWorld));
    }
  }
}
