"""Writes small ``.blend`` files in the format of Blender 2.5 to 2.79: any pointer size, any byte order.

The description of the structs (the catalogue at the start of this file) is written into every file, as Blender does;
the structs here have only the relevant fields.
"""

import re
import struct
from dataclasses import dataclass

CATALOGUE = """
ListBase { void *first; void *last; }
ID { void *next; void *prev; char name[66]; short flag; int us; IDProperty *properties; }
IDPropertyData { void *pointer; ListBase group; int val; int val2; }
IDProperty { IDProperty *next; IDProperty *prev; char type; char subtype; short flag; char name[64]; int saved;
  IDPropertyData data; int len; int totallen; }
bProperty { bProperty *next; bProperty *prev; char name[64]; short type; short flag; int data; void *poin; }
Object { ID id; short type; short partype; int par1; int par2; int par3; char parsubstr[64]; Object *parent;
  void *data; ListBase modifiers; ListBase constraints; Material **mat; char *matbits; int totcol; int actcol;
  float loc[3]; float dloc[3]; float size[3]; float dsize[3]; float rot[3]; float drot[3]; float quat[4];
  float dquat[4]; float rotAxis[3]; float drotAxis[3]; float rotAngle; float drotAngle; float parentinv[4][4];
  int lay; short transflag; short rotmode; short restrictflag; short boundtype; short collision_boundtype;
  short pad; int gameflag; int gameflag2; float mass; float damping; float inertia; float formfactor; float rdamping;
  ListBase prop; Group *dup_group; }
Mesh { ID id; Key *key; Material **mat; int totvert; int totedge; int totface; short totcol; short smoothresh;
  short flag; short pad; MVert *mvert; MFace *mface; MEdge *medge; CustomData fdata; int totpoly; int totloop;
  MPoly *mpoly; MLoop *mloop; CustomData pdata; CustomData ldata; }
MVert { float co[3]; short no[3]; char flag; char bweight; }
MFace { int v1; int v2; int v3; int v4; short mat_nr; char edcode; char flag; }
MPoly { int loopstart; int totloop; short mat_nr; char flag; char pad; }
MLoop { int v; int e; }
MLoopUV { float uv[2]; int flag; }
MTexPoly { Image *tpage; char flag; char transp; short mode; short tile; short pad; }
MTFace { float uv[4][2]; Image *tpage; char flag; char transp; short mode; short tile; short unwrap; }
CustomDataLayer { int type; int offset; int flag; int active; int active_rnd; int active_clone; int active_mask;
  char name[32]; void *data; }
CustomData { CustomDataLayer *layers; int typemap[34]; int totlayer; int maxlayer; int totsize; }
GameSettings { int flag; int alpha_blend; int face_orientation; int pad1; }
Material { ID id; float r; float g; float b; float alpha; float emit; float spec; short har; short pad; int mode;
  MTex *mtex[18]; GameSettings game; }
MTex { short texco; short mapto; Tex *tex; char uvname[32]; }
Tex { ID id; short type; short pad; Image *ima; }
Image { ID id; char name[240]; PackedFile *packedfile; short source; short type; }
PackedFile { int size; int seek; void *data; }
Lamp { ID id; short type; short mode; float r; float g; float b; float energy; float dist; float spotsize; }
Camera { ID id; float clipsta; float clipend; float lens; float sensor_x; }
World { ID id; short mistype; short mode; float horr; float horg; float horb; float ambr; float ambg; float ambb;
  float misi; float miststa; float mistdist; float misthi; }
GameData { float gravity; short matmode; short pad; }
Base { Base *next; Base *prev; int lay; int selcol; int flag; short sx; short sy; Object *object; }
Scene { ID id; World *world; ListBase base; GameData gm; }
Group { ID id; ListBase gobject; int layer; float dupli_ofs[3]; }
GroupObject { GroupObject *next; GroupObject *prev; Object *ob; }
ModifierData { ModifierData *next; ModifierData *prev; int type; int mode; char name[32]; }
MirrorModifierData { ModifierData modifier; short axis; short flag; }
EdgeSplitModifierData { ModifierData modifier; float split_angle; int flags; }
FileGlobal { char subvstr[4]; short subversion; short pads; Scene *curscene; }
"""
PLAIN = {"char": ("b", 1), "short": ("h", 2), "int": ("i", 4), "float": ("f", 4), "void": ("", 0)}
IDENTITY = [float(i % 5 == 0) for i in range(16)]


@dataclass
class Block:
    code: bytes
    address: int
    struct: int
    number: int
    content: bytes


class BlendWriter:
    """A file under construction. Every method returns the address of the block that it adds."""

    def __init__(self, *, pointer_size: int = 4, endian: str = "<", version: int = 262) -> None:
        self.pointer_size, self.endian, self.version = pointer_size, endian, version
        self.ids: list[Block] = []
        self._data: dict[int, list[Block]] = {}
        self._next = 0x1000
        self._parse()

    def _parse(self) -> None:
        self.structs: dict[str, list[tuple[str, str, int, int]]] = {}
        self.sizes = {name: size for name, (_, size) in PLAIN.items()}
        self.fields: list[tuple[str, list[tuple[str, str]]]] = []
        waiting = re.findall(r"(\w+) \{([^}]*)\}", CATALOGUE)
        while waiting:
            name, body = waiting.pop(0)
            members = [tuple(part.split(None, 1)) for part in body.replace("\n", " ").split(";") if part.strip()]
            if any("*" not in member and kind not in self.sizes for kind, member in members):
                waiting.append((name, body))
                continue
            layout, offset = [], 0
            for kind, member in members:
                count = 1
                for found in re.findall(r"\[(\d+)\]", member):
                    count *= int(found)
                size = self.pointer_size if "*" in member else self.sizes[kind]
                layout.append((re.search(r"\w+", member)[0], "*" if "*" in member else kind, count, offset))
                offset += size * count
            self.structs[name], self.sizes[name] = layout, offset
            self.fields.append((name, members))

    def address(self) -> int:
        """An unused address."""
        self._next += 0x10000
        return self._next

    def datablock(self, code: str, struct_name: str, name: str, address: int | None = None, /, **values: object) -> int:
        """A datablock, e.g. an object."""
        address = address or self.address()
        content = self.pack(struct_name, {"id": {"name": code + name, **values.pop("id", {})}, **values})
        self.ids.append(Block(code.encode(), address, self.index(struct_name), 1, content))
        return address

    def data(self, owner: int, struct_name: str | None, *items: dict | bytes, address: int | None = None) -> int:
        """Structs or bytes that belong to a datablock, which may be added before or afterwards."""
        address = address or self.address()
        content = b"".join(item if isinstance(item, bytes) else self.pack(struct_name, item) for item in items)
        self._data.setdefault(owner, []).append(
            Block(b"DATA", address, self.index(struct_name) if struct_name else 0, len(items), content)
        )
        return address

    def pointers(self, owner: int, addresses: list[int]) -> int:
        """An array of addresses."""
        kind = "Q" if self.pointer_size == 8 else "I"
        return self.data(owner, None, struct.pack(f"{self.endian}{len(addresses)}{kind}", *addresses))

    def chain(self, owner: int, struct_name: str, items: list[dict]) -> dict[str, int]:
        """A linked list. Returns the value for its field."""
        addresses = [self.address() for _ in items]
        for number, item in enumerate(items):
            links = {
                "prev": addresses[number - 1] if number else 0,
                "next": addresses[number + 1] if number + 1 < len(items) else 0,
            }
            if self.structs[struct_name][0][0] == "modifier":
                item = {**item, "modifier": {**links, **item.get("modifier", {})}}
            else:
                item = {**links, **item}
            self.data(owner, struct_name, item, address=addresses[number])
        return {"first": addresses[0], "last": addresses[-1]} if items else {}

    def index(self, name: str) -> int:
        return [known for known, _ in self.fields].index(name)

    def pack(self, name: str, values: dict) -> bytes:
        """The bytes of a struct; missing fields are zero."""
        content = bytearray(self.sizes[name])
        unknown = values.keys() - {member for member, _, _, _ in self.structs[name]}
        assert not unknown, f"{name} has no {unknown}"
        for member, kind, count, offset in self.structs[name]:
            if member not in values:
                continue
            value = values[member]
            if kind not in PLAIN and kind != "*":
                packed = self.pack(kind, value)
            elif isinstance(value, (bytes, str)):
                packed = (value.encode() if isinstance(value, str) else value)[:count]
            else:
                code = {"*": "Q" if self.pointer_size == 8 else "I"}.get(kind) or PLAIN[kind][0]
                items = list(value) if isinstance(value, (list, tuple)) else [value]
                packed = struct.pack(f"{self.endian}{len(items)}{code}", *items)
            content[offset : offset + len(packed)] = packed
        return bytes(content)

    def _description(self) -> bytes:
        names: list[str] = []
        types = [*PLAIN]
        rows: list[tuple[int, list[tuple[int, int]]]] = []

        def number(of: list[str], item: str) -> int:
            if item not in of:
                of.append(item)
            return of.index(item)

        for name, members in self.fields:
            number(types, name)
            rows.append(
                (types.index(name), [(number(types, kind), number(names, text.strip())) for kind, text in members])
            )
        e = self.endian

        def texts(tag: bytes, items: list[str]) -> bytes:
            out = tag + struct.pack(f"{e}i", len(items)) + b"".join(item.encode() + b"\0" for item in items)
            return out + b"\0" * (-len(out) % 4)

        out = b"SDNA" + texts(b"NAME", names) + texts(b"TYPE", types)
        lengths = [self.sizes.get(kind, 0) for kind in types]
        out += b"TLEN" + struct.pack(f"{e}{len(types)}H", *lengths)
        out += b"\0" * (-len(out) % 4) + b"STRC" + struct.pack(f"{e}i", len(rows))
        for kind, members in rows:
            out += struct.pack(f"{e}2H", kind, len(members))
            out += b"".join(struct.pack(f"{e}2H", *member) for member in members)
        return out

    def _head(self, code: bytes, content: bytes, address: int, index: int, count: int) -> bytes:
        kind = "Q" if self.pointer_size == 8 else "I"
        return struct.pack(f"{self.endian}4si{kind}ii", code, len(content), address, index, count) + content

    def finish(self) -> bytes:
        """The file."""
        mark = "-" if self.pointer_size == 8 else "_"
        out = [f"BLENDER{mark}{'v' if self.endian == '<' else 'V'}{self.version}".encode()]
        for block in self.ids:
            parts = [block, *self._data.get(block.address, [])]
            out.extend(self._head(part.code, part.content, part.address, part.struct, part.number) for part in parts)
        out.append(self._head(b"DNA1", self._description(), 0, 0, 1))
        out.append(self._head(b"ENDB", b"", 0, 0, 0))
        return b"".join(out)

    # scenes --------------------------------------------------------------------------------------

    def mesh(self, name: str, vertices: list, faces: list, *, materials: tuple[int, ...] = (), **values: object) -> int:
        """A mesh of triangles and quads."""
        address = self.address()
        points = self.data(address, "MVert", *({"co": vertex} for vertex in vertices))
        slots = self.pointers(address, list(materials)) if materials else 0
        rows = [dict(zip(("v1", "v2", "v3", "v4"), face, strict=False)) for face in faces]
        for row, (slot, smooth) in zip(rows, values.pop("shading", [(0, 0)] * len(rows)), strict=True):
            row.update(mat_nr=slot, flag=smooth)
        polygons = self.data(address, "MFace", *rows)
        return self.datablock(
            "ME", "Mesh", name, address, totvert=len(vertices), totface=len(faces), totcol=len(materials),
            mvert=points, mface=polygons, mat=slots, **values,
        )  # fmt: skip

    def object(self, name: str, data: int = 0, type: int = 0, address: int | None = None, **values: object) -> int:
        """An object at rest; see `CATALOGUE` for the fields."""
        defaults = {
            "size": [1.0] * 3,
            "parentinv": IDENTITY,
            "quat": [1.0, 0, 0, 0],
            "dquat": [1.0, 0, 0, 0],
            "rotmode": 1,
        }
        return self.datablock("OB", "Object", name, address, data=data, type=type, **{**defaults, **values})

    def scene(self, *objects: int, **values: object) -> int:
        """The active scene, with some objects."""
        address = self.address()
        base = self.chain(address, "Base", [{"object": obj, "lay": 1} for obj in objects])
        self.datablock("SC", "Scene", "Scene", address, base=base, gm={"gravity": 9.8}, **values)
        self.ids.insert(
            0, Block(b"GLOB", 0, self.index("FileGlobal"), 1, self.pack("FileGlobal", {"curscene": address}))
        )
        return address

    def property_group(self, owner: int, **properties: object) -> int:
        """Custom properties of a datablock. Returns the value for ``id={"properties": ...}``."""
        items = []
        for name, value in properties.items():
            data: dict[str, object] = {}
            kind = 8
            if isinstance(value, str):
                kind, data["pointer"] = 0, self.data(owner, None, value.encode() + b"\0rubbish")
            elif isinstance(value, int):
                kind, data["val"] = 1, int(value)
            else:
                low, high = struct.unpack(f"{self.endian}2i", struct.pack(f"{self.endian}d", value))
                data["val"], data["val2"] = low, high
            items.append({"name": name, "type": kind, "data": data})
        chain = self.chain(owner, "IDProperty", items)
        return self.data(owner, "IDProperty", {"type": 6, "data": {"group": chain}})

    def game_properties(self, owner: int, **properties: object) -> dict[str, int]:
        """Game properties of an object. Returns the value for ``prop=``."""
        items = []
        for name, value in properties.items():
            item: dict[str, object] = {"name": name}
            if isinstance(value, bool):
                item.update(type=0, data=int(value))
            elif isinstance(value, int):
                item.update(type=1, data=value)
            elif isinstance(value, float):
                item.update(type=2, data=struct.unpack("=i", struct.pack("=f", value))[0])
            else:
                item.update(type=3, poin=self.data(owner, None, str(value).encode() + b"\0rubbish"))
            items.append(item)
        return self.chain(owner, "bProperty", items)
