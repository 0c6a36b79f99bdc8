import type { Material } from "three";
import { DoubleSide, FrontSide, ImageLoader, MeshBasicMaterial, MeshLambertMaterial, MeshStandardMaterial, RepeatWrapping, SRGBColorSpace, Texture } from "three";
import { addressOf } from "../connection/tape";
import type { MaterialDescription } from "../generated/protocol";
import { expose } from "./air";

type Rgba = [number, number, number, number];

/** Textures are kept from world to world, so that a reloaded world is complete at once. */
const textures = new Map<string, Texture>();
const images = new ImageLoader();

/** The materials of one world, created on first use. */
export class MaterialStore {
  private readonly made = new Map<string, Material>();

  constructor(
    private readonly described: MaterialDescription[],
    private readonly wireframe: boolean,
    private readonly anisotropy: number,
    /** whether surfaces are drawn without gloss: on a processor, gloss takes up to half of the time */
    private readonly matt: boolean,
    private readonly onLoad: () => void,
  ) {}

  /** A material; the colour, if given, replaces its own. */
  get(index: number, color: Rgba | null): Material {
    const key = `${index}/${color?.join() ?? ""}`;
    let material = this.made.get(key);
    if (!material) {
      const description = this.described[index];
      if (!description) throw new Error(`the world has no material ${index}`);
      material = this.make(description, color ?? description.color);
      this.made.set(key, material);
    }
    return material;
  }

  private make(description: MaterialDescription, [r, g, b, alpha]: Rgba): Material {
    const map = description.image === null ? null : this.texture(description.image);
    const common = {
      map,
      side: description.double_sided ? DoubleSide : FrontSide,
      transparent: alpha < 1,
      opacity: alpha,
      depthWrite: alpha >= 0.99,
      wireframe: this.wireframe,
      // shadows of thin walls: front faces cast them
      shadowSide: description.double_sided ? DoubleSide : FrontSide,
    };
    if (description.shadeless) {
      const material = new MeshBasicMaterial({ ...common, toneMapped: false });
      material.color.setRGB(r, g, b);
      return material;
    }
    const material = this.matt
      ? new MeshLambertMaterial(common)
      : new MeshStandardMaterial({ ...common, metalness: description.metallic, roughness: description.roughness });
    material.color.setRGB(r, g, b);
    material.emissive.setRGB(...description.emission);
    expose(material);
    return material;
  }

  private texture(url: string): Texture {
    let texture = textures.get(url);
    if (!texture) {
      texture = this.load(url);
      texture.colorSpace = SRGBColorSpace;
      texture.wrapS = texture.wrapT = RepeatWrapping;
      texture.anisotropy = this.anisotropy;
      textures.set(url, texture);
    }
    return texture;
  }

  private load(url: string): Texture {
    const texture = new Texture();
    const fill = async (): Promise<void> => {
      texture.image = await images.loadAsync(await addressOf(url));
      texture.needsUpdate = true;
      this.onLoad();
    };
    fill().catch(() => console.error(`the texture ${url} cannot be shown`));
    return texture;
  }

  dispose(): void {
    for (const material of this.made.values()) material.dispose();
  }
}
