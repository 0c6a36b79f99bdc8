const RAISED = "⁰¹²³⁴⁵⁶⁷⁸⁹";

/** A unit with raised powers: components declare both ``m/s^2`` and ``m/s²``. */
export function unitText(unit: string): string {
  return unit.replace(/(?:\^|\*\*)(-?)(\d+)/g, (_, sign: string, digits: string) => {
    return (sign ? "⁻" : "") + [...digits].map((digit) => RAISED[Number(digit)]).join("");
  });
}
