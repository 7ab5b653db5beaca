"""Two CAN controllers with different bit rates on one wire, from the standard alone: CAN 2.0 frames, error signalling, fault
confinement, synchronisation. No code of Canopus. It predicts which error a node finds when, its counters, and who is bus-off.

A controller is a generator: it yields the level it drives in its next bit and gets the level at the sample point back.
"""
DOMINANT, RECESSIVE, IDLE = 0, 1, "idle"


def wire_bits(identifier, data):
    """SOF to EOF of a base frame, and what each is: [(level, is stuff bit)], number of the ACK slot."""
    plain = [0] + [identifier >> i & 1 for i in range(10, -1, -1)] + [0, 0, 0]
    plain += [len(data) >> i & 1 for i in range(3, -1, -1)]
    for byte in data:
        plain += [byte >> i & 1 for i in range(7, -1, -1)]
    register = 0
    for bit in plain:
        top = register >> 14 & 1
        register = register << 1 & 0x7FFF
        if top != bit:
            register ^= 0x4599
    plain += [register >> i & 1 for i in range(14, -1, -1)]
    out, run = [], []
    for bit in plain:
        out.append((bit, False))
        run = run + [bit] if run and run[-1] == bit else [bit]
        if len(run) == 5:
            out.append((1 - bit, True))
            run = [1 - bit]
    ack = len(out) + 1
    return out + [(1, False)] * 10, ack


class Reader:
    """What a controller knows of the frame it sees, bit by bit."""

    def __init__(self):
        self.plain, self.last, self.same, self.tail = [], None, 0, None

    def expects_ack(self):
        return self.tail == 1 and self.crc_fits()

    def crc_fits(self):
        size = 19 + 8 * self.length()
        register = 0
        for bit in self.plain[:size]:
            top = register >> 14 & 1
            register = register << 1 & 0x7FFF
            if top != bit:
                register ^= 0x4599
        return [register >> i & 1 for i in range(14, -1, -1)] == self.plain[size:size + 15]

    def length(self):
        if self.plain[12]:
            return 0
        return min(8, int("".join(map(str, self.plain[15:19])), 2))

    def arbitrating(self):
        return len(self.plain) <= 12

    def add(self, bit):
        """The error that a receiver finds; "end" behind the last bit of EOF, "overload" if that is dominant."""
        if self.tail is None:
            if self.same == 5:
                if bit == self.last:
                    return "stuff"
                self.last, self.same = bit, 1
            else:
                self.same = self.same + 1 if bit == self.last else 1
                self.last = bit
                self.plain.append(bit)
            full = len(self.plain) >= 19 and len(self.plain) == 19 + 8 * self.length() + 15
            if full and self.same < 5:
                self.tail = 0
            return None
        self.tail += 1
        if self.tail == 2:  # the ACK slot may be anything
            return None
        if self.tail == 3 and bit == RECESSIVE and not self.crc_fits():
            return "CRC"
        if self.tail == 10:
            return "end" if bit else "overload"
        return None if bit else "form"


class Node:
    def __init__(self, name, rate, joins=False):
        """`joins`: it comes to the bus at 0, and waits for 11 recessive bits; else it is there already."""
        self.name, self.bit = name, 1_000_000_000 // rate
        self.tec = self.rec = 0
        self.off = False
        self.queue = []
        self.drives, self.start, self.next, self.at_sample = RECESSIVE, None, None, False
        self.sampled, self.synchronised, self.hard = RECESSIVE, False, True
        self.found, self.pending = [], None
        self.machine = self.controller(joins)
        if next(self.machine) != IDLE:
            self.start, self.next, self.at_sample = 0, self.bit - self.bit // 8, True

    def passive(self):
        return self.tec > 127 or self.rec > 127

    def receiver_counts(self, by):
        self.rec = min(self.rec + by, 255)

    def note(self, error):
        self.found.append(error)

    # --- the protocol

    def controller(self, joins):
        recessive = 0 if joins else 11
        while recessive < 11:
            recessive = recessive + 1 if (yield RECESSIVE) else 0
        while not self.off:
            self.hard = True
            why = yield IDLE
            yield from self.frames(sends=why == "send", sof_seen=False)
        self.hard = False
        while True:  # recovery takes longer than anybody looks here
            yield RECESSIVE

    def frames(self, sends, sof_seen):
        """Frames without an idle bus between them."""
        while True:
            state, was_sender = yield from self.frame(sends, sof_seen)
            while state != "sof":
                if self.off or state in ("glitch", "done"):
                    return
                if state in ("end", "intermission"):
                    state = yield from self.intermission(was_sender)
                else:
                    state = yield from self.flag(state, was_sender)
            sends, sof_seen = bool(self.queue) and not (was_sender and self.passive()), True

    def frame(self, sends, sof_seen):
        """How it ended: "end", "overload", or ("error", flag is passive, open); whether it was sent by this node."""
        reader = Reader()
        self.hard = False
        sent, ack = wire_bits(*self.queue[0]) if sends else ([], None)
        is_sender, number = sends, 0
        if sof_seen:
            reader.add(DOMINANT)
            number = 1
        while True:
            level, is_stuff = sent[number] if is_sender else (DOMINANT if reader.expects_ack() else RECESSIVE, False)
            seen = yield level
            if number == 0 and not is_sender and seen == RECESSIVE:
                return "glitch", False
            if is_sender:
                if level == DOMINANT and seen == RECESSIVE:
                    return self.error("bit", True), True
                if number == ack:
                    if seen == RECESSIVE:
                        return self.error("acknowledgement", True), True
                elif level == RECESSIVE and seen == DOMINANT:
                    if not reader.arbitrating() or number >= ack - 1:
                        return self.error("bit", True), True
                    if is_stuff:
                        return self.error("stuff", True, counts=False), True
                    is_sender = False
            error = reader.add(seen)
            number += 1
            if error in ("stuff", "CRC", "form") and not is_sender:
                return self.error(error, False), False
            if error in ("end", "overload"):
                if is_sender:
                    self.tec = max(self.tec - 1, 0)
                    self.queue.pop(0)
                elif self.rec > 0:
                    self.rec = self.rec - 1 if self.rec <= 127 else 127
                return error, is_sender

    def error(self, kind, is_sender, counts=True):
        passive = self.passive()
        is_open = False
        if counts:
            if not is_sender:
                self.receiver_counts(1)
            elif passive and kind == "acknowledgement":
                is_open = True
            else:
                self.tec += 8
        self.off = self.tec > 255
        self.note(kind)
        return "error", passive, is_open

    def severe(self, was_sender):
        if was_sender:
            self.tec += 8
            self.off = self.tec > 255
        else:
            self.receiver_counts(8)

    def flag(self, which, was_sender):
        """Flag, the others' flags and the delimiter of an error or overload frame. What comes then."""
        self.hard = False
        is_overload = which == "overload"
        if is_overload or not which[1]:
            for _ in range(6):
                if (yield DOMINANT) == RECESSIVE:
                    passive = self.passive()
                    self.severe(was_sender)
                    self.note("bit")
                    return "error", passive, False
        else:
            is_open, equal, last = which[2], 0, None
            while equal < 6:
                seen = yield RECESSIVE
                if seen == DOMINANT and is_open:
                    is_open = False
                    self.tec += 8
                    self.off = self.tec > 255
                    if self.off:
                        return "off"
                equal, last = (equal + 1 if seen == last else 1), seen
        dominant = 0
        while (yield RECESSIVE) == DOMINANT:
            dominant += 1
            if dominant == 1 and not is_overload and not was_sender:
                self.receiver_counts(8)
            if dominant % 8 == 0:
                self.severe(was_sender)
                if self.off:
                    return "off"
        for number in range(2, 9):
            if (yield RECESSIVE) == DOMINANT:
                return "overload" if number == 8 else self.error("form", was_sender)
        return "intermission"

    def intermission(self, was_sender):
        for number in range(1, 4):
            self.hard = number > 1
            if (yield RECESSIVE) == DOMINANT:
                return "overload" if number < 3 else "sof"
        self.hard = True
        if was_sender and self.passive():
            for _ in range(8):
                if (yield RECESSIVE) == DOMINANT:
                    return "sof"
        return "done"


def predict(nodes, sends, until):
    """`sends`: (ns, node, identifier, data) in order of time. Errors found: [(ns, name, kind, TEC, REC)], up to `until`."""
    sends, errors, wire, now = list(sends), [], RECESSIVE, 0

    def begin(node, level):
        node.drives = RECESSIVE if level == IDLE else level
        if level == IDLE:
            node.start = node.next = None
        else:
            node.start, node.at_sample = now, True
            node.next = now + node.bit - node.bit // 8
        node.synchronised, node.pending = False, None

    while True:
        moments = [node.next for node in nodes if node.next is not None] + [send[0] for send in sends[:1]]
        moments += [now for node in nodes if node.next is None and node.queue and not node.off]
        if not moments or min(moments) > until:
            return errors
        now = max(now, min(moments))
        while sends and sends[0][0] <= now:
            _, node, identifier, data = sends.pop(0)
            node.queue.append((identifier, data))
            node.queue.sort(key=lambda frame: frame[0])
        for node in nodes:
            if node.next == now and not node.at_sample:
                begin(node, node.pending)
            if node.next is None and node.queue and not node.off:
                begin(node, node.machine.send("send"))
        level = min(node.drives for node in nodes)
        if level == DOMINANT:
            for node in nodes:
                if node.next is None:
                    begin(node, node.machine.send("edge"))
                    node.synchronised = True
        if level != wire:
            wire = level
            if wire == DOMINANT:
                for node in nodes:
                    synchronise(node, now)
        for node in nodes:
            if node.next == now and node.at_sample:
                node.sampled, node.synchronised, node.at_sample = wire, False, False
                node.next = node.start + node.bit
                node.pending = node.machine.send(wire)  # begins when this bit ends
                for kind in node.found:
                    errors.append((now, node.name, kind, node.tec, node.rec))
                node.found.clear()


def synchronise(node, now):
    if node.sampled == DOMINANT or node.synchronised:
        return
    if node.start == now and node.at_sample:
        node.synchronised = True
        return
    jump = node.bit // 8
    if node.hard:
        node.synchronised, node.start, node.at_sample = True, now, True
        node.next = now + node.bit - node.bit // 8
        if node.pending == IDLE:  # it was at the end of its last bit
            node.pending, node.drives = None, node.machine.send("edge")
    elif node.at_sample:
        if node.drives == DOMINANT:
            return
        node.synchronised = True
        late = min(now - node.start, jump)
        node.start += late
        node.next += late
    else:
        node.synchronised = True
        node.next -= min(node.next - now, jump)
