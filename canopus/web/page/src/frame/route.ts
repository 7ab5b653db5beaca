// The address of what is shown: "#/trace?filter=node%3D3&at=1.5" is a screen, "#/objects/line1/3" one of its things.

export interface Route {
  screen: string;
  path: string[];
  query: Record<string, string>;
}

const decode = (text: string): string => {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;  // typed by hand
  }
};

export function parse_route(hash: string): Route {
  const [path = "", query = ""] = hash.replace(/^#\/?/, "").split("?", 2);
  const [screen = "", ...rest] = path.split("/").filter(Boolean).map(decode);
  const pairs = query.split("&").filter(Boolean).map((pair): [string, string] => {
    const at = pair.indexOf("=");
    return at < 0 ? [decode(pair), ""] : [decode(pair.slice(0, at)), decode(pair.slice(at + 1))];
  });
  return { screen, path: rest, query: Object.fromEntries(pairs) };
}

export function link(screen: string, path: readonly (string | number)[] = [], query: Record<string, string | number | undefined> = {}): string {
  const place = [screen, ...path].map((part) => encodeURIComponent(part)).join("/");
  const words = Object.entries(query).filter(([, value]) => value !== undefined && value !== "").map(([key, value]) => `${key}=${encodeURIComponent(value!)}`);
  return `#/${place}${words.length ? `?${words.join("&")}` : ""}`;
}
