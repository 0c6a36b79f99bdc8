import { BufferAttribute, BufferGeometry, Color, LineSegments, Points, ShaderChunk, ShaderMaterial, SRGBColorSpace, Vector3 } from "three";
import type { MeshLambertMaterial, MeshStandardMaterial, Object3D } from "three";
import type { Connection } from "../connection/connection";
import type { PoseFrame } from "../connection/frames";
import type { AirLook, AirPart } from "../generated/protocol";
import type { Signal } from "../ui/signal";
import type { Stage } from "../view/stage";

/** Side of the cube around the camera in which drops and flakes are drawn, m. */
const CUBE = 12;
/** Maximum number of drops or flakes. */
const MOST = 2500;
/** Speeds of fall, m/s; time for which a drop is exposed, s. */
const SPEED = { rain: 7, snow: 1.2 };
const EXPOSURE = 1 / 50;

// the transmission of Koschmieder, exp(-extinction * distance), of light and not of its codes
ShaderChunk.fog_fragment = /* glsl */ `
#if defined(USE_FOG) && defined(FOG_EXP2)
  vec3 clear = sRGBTransferEOTF(gl_FragColor).rgb, veil = sRGBTransferEOTF(vec4(fogColor, 1.0)).rgb;
  gl_FragColor = sRGBTransferOETF(vec4(mix(veil, clear, exp(-fogDensity * vFogDepth)), gl_FragColor.a));
#else
  ${ShaderChunk.fog_fragment}
#endif`;

/** What the ground of all materials has on it. */
const ground = { wet: { value: 0 }, snow: { value: 0 }, sky: { value: new Color() } };

/** Let a material be wet and covered with snow where its surface is level: the formulas of the cameras. */
export function expose(material: MeshStandardMaterial | MeshLambertMaterial): void {
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, { groundWet: ground.wet, groundSnow: ground.snow, groundSky: ground.sky });
    shader.fragmentShader = shader.fragmentShader
      .replace("void main() {", "uniform float groundWet, groundSnow;\nuniform vec3 groundSky;\nvoid main() {")
      .replace(
        /#include <lights_(physical|lambert)_fragment>/,
        /* glsl */ `
        if (groundWet + groundSnow > 0.0) {
          float rise = inverseTransformDirection(normal, viewMatrix).z;
          float water = groundWet * smoothstep(0.93, 0.96, rise);
          diffuseColor.rgb *= 1.0 - 0.4 * water;
          float grazing = 1.0 - clamp(dot(normal, normalize(vViewPosition)), 0.0, 1.0);
          totalEmissiveRadiance += groundSky * water * (0.02 + 0.98 * pow(grazing, 5.0));
          diffuseColor.rgb = mix(diffuseColor.rgb, vec3(0.83), groundSnow * smoothstep(0.66, 0.74, rise));
        }
        $&`,
      );
  };
}

const vertex = /* glsl */ `
uniform vec3 velocity, middle;
uniform float time, side, size;
attribute float end;
void main() {
  // places in the world that repeat from cube to cube, so that they stay when the camera moves
  vec3 at = mod(position * side + velocity * time - middle + 0.5 * side, side) - 0.5 * side + middle;
  gl_Position = projectionMatrix * viewMatrix * vec4(at - velocity * end, 1.0);
  gl_PointSize = clamp(size / gl_Position.w, 1.0, 12.0);
}`;

const fragment = /* glsl */ `
uniform vec3 color;
uniform float opacity;
void main() {
  gl_FragColor = vec4(color, opacity);
  #include <colorspace_fragment>
}`;

/** Drops or flakes around the camera; they move with the simulated time. */
class Falling {
  readonly object: Object3D;
  private readonly geometry = new BufferGeometry();
  private readonly uniforms = {
    velocity: { value: new Vector3() },
    middle: { value: new Vector3() },
    color: { value: new Color() },
    time: { value: 0 },
    side: { value: CUBE },
    size: { value: 14 },
    opacity: { value: 0.5 },
  };

  constructor(
    private readonly kind: "rain" | "snow",
    private readonly each: number,
  ) {
    const places = new Float32Array(MOST * each * 3);
    const ends = new Float32Array(MOST * each);
    for (let i = 0; i < MOST; i++) {
      const place = [Math.random(), Math.random(), Math.random()];
      for (let k = 0; k < each; k++) {
        places.set(place, (i * each + k) * 3);
        ends[i * each + k] = k * EXPOSURE;
      }
    }
    this.geometry.setAttribute("position", new BufferAttribute(places, 3));
    this.geometry.setAttribute("end", new BufferAttribute(ends, 1));
    const material = new ShaderMaterial({
      uniforms: this.uniforms,
      vertexShader: vertex,
      fragmentShader: fragment,
      transparent: true,
      depthWrite: false,
      fog: false,
    });
    this.object = each === 2 ? new LineSegments(this.geometry, material) : new Points(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.visible = false;
    this.object.raycast = () => {};
    if (kind === "rain") this.uniforms.opacity.value = 0.3;
  }

  /** Show the drops of a rate, mm/h. */
  show(part: AirPart | null, wind: [number, number, number], camera: Vector3, color: Color): void {
    const rate = part?.[this.kind] ?? 0;
    this.object.visible = rate > 0;
    // more in heavier rain, as the number of drops beyond 1 mm
    this.geometry.setDrawRange(0, this.each * Math.min(MOST, Math.round(250 * rate ** 0.63)));
    this.uniforms.velocity.value.set(wind[0], wind[1], wind[2] - SPEED[this.kind]);
    this.uniforms.middle.value.copy(camera);
    this.uniforms.color.value.copy(color).lerp(new Color(1, 1, 1), 0.4);
  }

  at(time: number): void {
    this.uniforms.time.value = time;
  }
}

/** Fog, rain, snow and wet ground in the view, as the weather at the camera is. */
export class Air {
  private look: AirLook | null = null;
  private shown: AirPart | null = null;
  private readonly color = new Color();
  private readonly falling = [new Falling("rain", 2), new Falling("snow", 1)];
  private readonly still = matchMedia("(prefers-reduced-motion: reduce)");

  constructor(
    connection: Connection,
    private readonly stage: Stage,
    poses: Signal<PoseFrame | null>,
  ) {
    stage.scene.add(...this.falling.map(({ object }) => object));
    connection.on("air_look", (look) => {
      this.look = look;
      stage.invalidate();
    });
    connection.on("welcome", () => (this.look = null));
    poses.watch((frame) => {
      if (!frame) return;
      for (const one of this.falling) one.at(frame.time);
      if (this.falling.some(({ object }) => object.visible)) stage.invalidate();
    });
    stage.onDraw(() => this.update());
  }

  /** The part of the world in which the camera is. */
  private here(): AirPart | null {
    const [outside, ...parts] = this.look?.parts ?? [];
    const { x, y, z } = this.stage.view.position;
    const inside = ({ corners, top }: AirPart): boolean =>
      (top === null || z <= top) &&
      corners.every(([ax, ay], i) => {
        const [bx, by] = corners[(i + 1) % corners.length] as [number, number];
        return (bx - ax) * (y - ay) >= (by - ay) * (x - ax);
      });
    return parts.find(inside) ?? outside ?? null;
  }

  private update(): void {
    const { sky, lights, view } = this.stage;
    const part = this.here();
    if (part !== this.shown) {
      this.shown = part;
      if (part) this.color.setRGB(...part.color, SRGBColorSpace);
      sky.fill(part ? { color: this.color, extinction: part.extinction, overhead: part.overhead } : null);
      lights.cloud(part ? 1 - Math.exp(-part.overhead) : 0);
    }
    ground.wet.value = this.look?.wet ?? 0;
    ground.snow.value = this.look?.snow_cover ?? 0;
    ground.sky.value.copy(part ? this.color : sky.horizon);
    const falls = this.still.matches || sky.submerged ? null : part;
    for (const one of this.falling) one.show(falls, this.look?.wind ?? [0, 0, 0], view.position, this.color);
  }
}
