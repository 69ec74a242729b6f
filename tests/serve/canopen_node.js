// An unmodified npm `canopen` operates a served drive: each check is a line, "ok ..." or "FAILED ...".
// usage: node canopen_node.js CLIENTS HOST:PORT EDS
const net = require('net');

const [clients, place, sheet] = process.argv.slice(2);
const { Device, Eds, DataType } = require(`${clients}/node_modules/canopen`);
const SAVE = 0x65766173;
const TURN = 65536;

function that(condition, what) {
    console.log(`${condition ? 'ok' : 'FAILED'} ${what}`);
}

const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

async function until(condition, what) {
    for (let i = 0; i < 500; i++) {
        if (await condition()) {
            that(true, what);
            return;
        }
        await pause(10);
    }
    that(false, what);
}

// Frames as text, by TCP: what a serial adapter would do.
function carry(socket, device) {
    let rest = '';
    socket.setNoDelay(true);
    socket.on('data', (bytes) => {
        const lines = (rest + bytes.toString('latin1')).split('\r');
        rest = lines.pop();
        for (const line of lines) {
            const frame = /(?:^|[\x07z])t([0-9A-F]{3})([0-8])([0-9A-F]*)$/.exec(line);
            if (frame) {
                device.receive({ id: parseInt(frame[1], 16), len: Number(frame[2]),
                    data: Buffer.from(frame[3], 'hex') });
            }
        }
    });
    device.addListener('message', ({ id, data }) => {
        socket.write(`t${id.toString(16).padStart(3, '0')}${data.length}${data.toString('hex')}\r`);
    });
}

class Drive {
    constructor(device) {
        this.device = device;
    }

    read(index, subIndex, dataType, more = {}) {
        return this.device.sdo.upload({ serverId: 1, index, subIndex, dataType, timeout: 2000, ...more });
    }

    write(index, subIndex, dataType, data, more = {}) {
        return this.device.sdo.download({ serverId: 1, index, subIndex, dataType, data, timeout: 2000, ...more });
    }

    status() {
        return this.read(0x6041, 0, DataType.UNSIGNED16);
    }

    control(word) {
        return this.write(0x6040, 0, DataType.UNSIGNED16, word);
    }
}

async function refused(access, code) {
    try {
        await access;
        that(false, `refused with ${code.toString(16)}`);
    } catch (error) {
        that(error.code === code, `refused: ${error.message}`);
    }
}

// Every object of the sheet is read, and is as long as the sheet says.
async function everyObject(drive, eds) {
    let read = 0;
    for (const entry of eds.values()) {
        const several = entry.subNumber ? [0, 1, 2, 3, 4, 5, 6, 7, 8].map((sub) => entry.at(sub)) : [entry];
        for (const object of several) {
            if (!object || object.accessType === 'wo' || object.dataType === DataType.DOMAIN) {
                continue;
            }
            if (entry.index === 0x1003 && object.subIndex > 0) { // no error has come
                await refused(drive.read(entry.index, object.subIndex, null), 0x08000024);
                continue;
            }
            const data = await drive.read(entry.index, object.subIndex || 0, null);
            const text = object.dataType === DataType.VISIBLE_STRING;
            if (!text && object.size && data.length !== object.size) {
                that(false, `${entry.index.toString(16)}: ${data.length} bytes, not ${object.size}`);
            }
            read++;
        }
    }
    that(read > 150, `${read} objects are read`);
}

async function settings(drive) {
    that(await drive.read(0x2120, 0, DataType.REAL64) === 3, 'a real number is read');
    await drive.write(0x2120, 0, DataType.REAL64, 2.5);
    that(await drive.read(0x2120, 0, DataType.REAL64) === 2.5, 'and written');
    await refused(drive.write(0x2120, 0, DataType.REAL64, 100), 0x06090030);
    await refused(drive.read(0x5000, 0, DataType.UNSIGNED8), 0x06020000);
    await drive.write(0x2120, 0, DataType.REAL64, 3, { blockTransfer: true });
    that(await drive.read(0x2120, 0, DataType.REAL64, { blockTransfer: true }) === 3, 'in blocks, too');
}

async function move(drive, device) {
    const received = [];
    device.pdo.on('pdo', (pdo) => received.push(pdo));
    device.nmt.startNode(1);
    for (const word of [0x06, 0x07, 0x0f]) {
        await drive.control(word);
        const state = { 0x06: 0x21, 0x07: 0x23, 0x0f: 0x27 }[word];
        await until(async () => ((await drive.status()) & 0x6f) === state, `state ${state.toString(16)}`);
    }
    await drive.write(0x6060, 0, DataType.INTEGER8, 1);
    await drive.write(0x607a, 0, DataType.INTEGER32, TURN / 2);
    await drive.control(0x1f);
    await until(async () => (await drive.status()) & 0x1000, 'the set-point is acknowledged');
    await drive.control(0x0f);
    await until(async () => (await drive.status()) & 0x400, 'and reached');
    that(Math.abs(await drive.read(0x6064, 0, DataType.INTEGER32) - TURN / 2) < 100, 'half a turn');
    that(received.some((pdo) => pdo.cobId === 0x181), 'the statusword comes by PDO');
}

async function quickStopAndStore(drive) {
    await drive.control(0x0b);
    await until(async () => ((await drive.status()) & 0x6f) === 0x40, 'a quick stop ends with it off');
    await drive.write(0x1010, 1, DataType.UNSIGNED32, SAVE);
}

// A PDO of one byte, where two are mapped.
async function emergencies(device, socket) {
    const codes = [];
    device.emcy.on('emergency', ({ em }) => codes.push(em.code));
    socket.write('t201106\r');
    await until(() => codes.length === 1 && codes[0] === 0x8210, 'a PDO that is too short is an emergency');
    socket.write('t20120600\r');
    await until(() => codes.length === 2 && codes[1] === 0, 'which one that is right ends');
}

async function network(device) {
    const states = [];
    device.nmt.on('heartbeat', ({ deviceId, state }) => deviceId === 1 && states.push(state));
    device.nmt.resetNode(1);
    await until(async () => states.includes(0), 'it boots anew');
}

async function main(socket) {
    const eds = Eds.fromFile(sheet);
    const own = new Eds();
    own.addSdoClientParameter(1, 0x601, 0x581);
    own.addHeartbeatConsumer(1, 500);
    own.addEmcyConsumer(0x81);
    const shown = own.addEntry(0x6041, { parameterName: 'Statusword', dataType: DataType.UNSIGNED16 });
    own.addReceivePdo({ cobId: 0x181, dataObjects: [shown] });
    const device = new Device({ eds: own, id: 0x10 });
    const drive = new Drive(device);
    carry(socket, device);
    socket.write('C\rS6\rO\r');
    device.start();
    device.nmt.startNode(); // its own
    await pause(100);
    await everyObject(drive, eds);
    await settings(drive);
    await move(drive, device);
    await quickStopAndStore(drive);
    await emergencies(device, socket);
    await network(device);
    device.stop();
    socket.write('C\r');
    socket.end();
}

const [host, port] = place.split(':');
const socket = net.connect(Number(port), host, () => {
    main(socket).catch((error) => {
        that(false, error.stack);
        process.exit(1);
    });
});
