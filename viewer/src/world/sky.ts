import type { Scene } from "three";
import { BackSide, Color, Fog, FogExp2, Mesh, ShaderMaterial, SphereGeometry, Vector3 } from "three";
import type { ViewDescription } from "../generated/protocol";

const SKY = { horizon: 0xf4f8fb, zenith: 0x6ea6de, nadir: 0xc3cad0, glow: 0xfff1d6 };

/** Under water, as in the images of cameras: linear colour near the surface, depth at which a quarter of the light is left, sight (m). */
const WATER = { tint: [0.012, 0.155, 0.2] as const, darker: 16, sight: 26 };

const vertex = /* glsl */ `
varying vec3 direction;
void main() {
  direction = (modelMatrix * vec4(position, 0.0)).xyz;
  gl_Position = (projectionMatrix * modelViewMatrix * vec4(position, 1.0)).xyww;
}`;

const fragment = /* glsl */ `
uniform vec3 horizon, zenith, nadir, sun, glow, air;
uniform float overhead;
varying vec3 direction;
void main() {
  vec3 d = normalize(direction);
  float up = max(d.z, 0.0), down = max(-d.z, 0.0);
  vec3 color = mix(horizon, zenith, 1.0 - pow(1.0 - up, 2.6));
  color = mix(color, nadir, 1.0 - pow(1.0 - min(down * 3.0, 1.0), 2.0));
  float near = max(dot(d, sun), 0.0);
  color += glow * (0.22 * pow(near, 12.0) + 0.5 * pow(near, 400.0));
  gl_FragColor = vec4(color, 1.0);
  #include <tonemapping_fragment>
  #include <colorspace_fragment>
  // air that is not clear covers the sky, as it covers objects
  if (overhead > 0.0) {
    vec3 clear = sRGBTransferEOTF(gl_FragColor).rgb;
    gl_FragColor = sRGBTransferOETF(vec4(mix(air, clear, exp(-overhead / max(d.z, 0.002))), 1.0));
  }
}`;

/** Air that is not clear: the light that it scatters, its extinction (1/m), and the optical depth of all air above. */
export interface Haze {
  color: Color;
  extinction: number;
  overhead: number;
}

/** The sky: a gradient from the horizon up, with the mist that hides distant objects. */
export class Sky {
  private readonly uniforms = {
    horizon: { value: new Color() },
    zenith: { value: new Color() },
    nadir: { value: new Color() },
    glow: { value: new Color() },
    sun: { value: new Vector3(0, 0, 1) },
    air: { value: new Color() },
    overhead: { value: 0 },
  };
  private haze: Haze | null = null;
  private readonly dome: Mesh;
  private view: ViewDescription | null = null;
  /** metres of water above the camera */
  private depth = 0;

  constructor(private readonly scene: Scene) {
    const material = new ShaderMaterial({
      uniforms: this.uniforms,
      vertexShader: vertex,
      fragmentShader: fragment,
      side: BackSide,
      depthWrite: false,
      fog: false,
    });
    this.dome = new Mesh(new SphereGeometry(1, 32, 24), material);
    this.dome.frustumCulled = false;
    this.dome.renderOrder = -1;
    this.dome.onBeforeRender = (_renderer, _scene, camera) => {
      this.dome.position.setFromMatrixPosition(camera.matrixWorld);
      this.dome.updateMatrixWorld();
      this.dome.modelViewMatrix.multiplyMatrices(camera.matrixWorldInverse, this.dome.matrixWorld);
    };
    scene.add(this.dome);
  }

  get horizon(): Color {
    return this.uniforms.horizon.value;
  }

  get submerged(): boolean {
    return this.depth > 0;
  }

  /** Fill the air with fog, or clear it. */
  fill(haze: Haze | null): void {
    this.haze = haze;
    this.paint(this.view, this.uniforms.sun.value);
  }

  /** The light for a camera at a height; returns whether it is under water. */
  at(height: number): boolean {
    const { water } = this.view ?? {};
    const depth = water == null ? 0 : Math.max(0, water - height);
    if (Math.abs(depth - this.depth) >= 0.05 || depth > 0 !== this.depth > 0) {
      this.depth = depth;
      this.paint(this.view, this.uniforms.sun.value);
    }
    return depth > 0;
  }

  private dive(): void {
    const { horizon, zenith, nadir, glow } = this.uniforms;
    horizon.value.setRGB(...WATER.tint).multiplyScalar((1 + this.depth / WATER.darker) ** -2);
    zenith.value.copy(horizon.value).multiplyScalar(2.2);
    nadir.value.copy(horizon.value).multiplyScalar(0.35);
    glow.value.set(0);
    this.scene.fog = new Fog(horizon.value, 0, WATER.sight);
  }

  /** A clear day, or the colours of the script. */
  paint(view: ViewDescription | null, towardsSun: Vector3): void {
    this.view = view;
    const { horizon, zenith, nadir, glow, sun } = this.uniforms;
    const asked = view?.horizon_color;
    if (asked) {
      horizon.value.setRGB(...asked);
      zenith.value.copy(horizon.value).multiplyScalar(0.55);
      nadir.value.copy(horizon.value).multiplyScalar(0.7);
    } else {
      horizon.value.set(SKY.horizon);
      zenith.value.set(SKY.zenith);
      nadir.value.set(SKY.nadir);
    }
    glow.value.set(SKY.glow);
    if (asked) glow.value.multiplyScalar(0.3);
    for (const color of [horizon, zenith, nadir, glow]) color.value.multiplyScalar(view?.daylight ?? 1);
    sun.value.copy(towardsSun);
    const mist = view?.mist;
    this.scene.fog = mist ? new Fog(horizon.value, mist.start, mist.start + mist.depth) : null;
    const { air, overhead } = this.uniforms;
    overhead.value = this.depth > 0 ? 0 : (this.haze?.overhead ?? 0);
    if (this.haze) {
      air.value.copy(this.haze.color).multiplyScalar(view?.daylight ?? 1);
      this.scene.fog = new FogExp2(air.value, this.haze.extinction);
    }
    if (this.depth > 0) this.dive();
  }
}
