// The windows of the configuration tool as a tree: "PDO list: Transmit PDO" stands below "PDO list". No browser is needed here.

export interface TreeItem {
  word: string;
  title: string;
}

export interface TreeGroup {
  title: string;
  items: TreeItem[];
}

/** In the order of the windows; a window without a colon is a group of its own. */
export function tree_of(windows: readonly TreeItem[]): TreeGroup[] {
  const groups: TreeGroup[] = [];
  for (const { word, title } of windows) {
    const at = title.indexOf(": ");
    const group = at < 0 ? "" : title.slice(0, at);
    const last = groups.at(-1);
    if (group && last?.title === group) last.items.push({ word, title: title.slice(at + 2) });
    else groups.push({ title: group, items: [{ word, title: at < 0 ? title : title.slice(at + 2) }] });
  }
  return groups;
}
