import type { Vector3 } from "three";

/** Distance below which a sound does not get louder, m. */
const NEAREST = 1;
/** Frequency of the tone of the first loudspeaker, Hz; the others are higher by one step each. */
const TONE = 440;
/** Steps of a pentatonic scale, whose tones harmonise. */
const STEPS = [1, 9 / 8, 5 / 4, 3 / 2, 5 / 3];
const TONE_LOUDNESS = 0.3;
/** Duration of fade-in and fade-out, s, which avoids clicks. */
const FADE = 0.02;

/** One loudspeaker: its sound, its volume and its position. */
export class Voice {
  private readonly gain: GainNode;
  private readonly panner: PannerNode;
  private source: AudioScheduledSourceNode | null = null;

  constructor(
    private readonly context: BaseAudioContext,
    output: AudioNode,
  ) {
    this.gain = new GainNode(context, { gain: 0 });
    // the sound pressure is inversely proportional to the distance
    this.panner = new PannerNode(context, { panningModel: "equalpower", distanceModel: "inverse", refDistance: NEAREST, rolloffFactor: 1 });
    this.gain.connect(this.panner).connect(output);
  }

  get playing(): boolean {
    return this.source !== null;
  }

  /** Play a recorded sound repeatedly, from an offset in seconds. */
  playBuffer(buffer: AudioBuffer, offset: number): void {
    const source = new AudioBufferSourceNode(this.context, { buffer, loop: true });
    this.begin(source, 1);
    source.start(0, buffer.duration > 0 ? offset % buffer.duration : 0);
  }

  /** Play a tone with a different pitch for each loudspeaker. */
  playTone(index: number): void {
    const octave = 2 ** (Math.floor(index / STEPS.length) % 3);
    const source = new OscillatorNode(this.context, { type: "triangle", frequency: TONE * octave * (STEPS[index % STEPS.length] as number) });
    this.begin(source, TONE_LOUDNESS);
    source.start();
  }

  stop(): void {
    if (!this.source) return;
    const now = this.context.currentTime;
    this.gain.gain.setTargetAtTime(0, now, FADE / 3);
    this.source.stop(now + FADE);
    this.source = null;
  }

  /** Position in the world, metres. */
  place({ x, y, z }: Vector3): void {
    set(this.panner.positionX, x);
    set(this.panner.positionY, y);
    set(this.panner.positionZ, z);
  }

  dispose(): void {
    this.stop();
    setTimeout(() => this.panner.disconnect(), 1000 * FADE * 3);
  }

  private begin(source: AudioScheduledSourceNode, loudness: number): void {
    this.stop();
    source.connect(this.gain);
    const now = this.context.currentTime;
    this.gain.gain.cancelScheduledValues(now);
    this.gain.gain.setTargetAtTime(loudness, now, FADE / 3);
    this.source = source;
  }
}

/** Place the listener at the camera. */
export function listen(listener: AudioListener, position: Vector3, ahead: Vector3, above: Vector3): void {
  set(listener.positionX, position.x);
  set(listener.positionY, position.y);
  set(listener.positionZ, position.z);
  set(listener.forwardX, ahead.x);
  set(listener.forwardY, ahead.y);
  set(listener.forwardZ, ahead.z);
  set(listener.upX, above.x);
  set(listener.upY, above.y);
  set(listener.upZ, above.z);
}

function set(parameter: AudioParam, value: number): void {
  if (parameter.value !== Math.fround(value)) parameter.value = value;
}
